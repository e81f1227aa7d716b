// Which tiles of the picture hold dots, or have some within reach.
#version 330 core

uniform usampler2D nearest;
out float out_dots;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * TILE, last = textureSize(nearest, 0) - 1;
    uint closest = 0xFFFFFFFFu;
    for (int y = -REACH; y < TILE + REACH; ++y) {
        for (int x = -REACH; x < TILE + REACH; ++x) {
            closest = min(closest, texelFetch(nearest, clamp(corner + ivec2(x, y), ivec2(0), last), 0).r);
        }
    }
    out_dots = closest == 0xFFFFFFFFu ? 0.0 : 1.0;
}

// Marks tiles of the picture with points inside them or within RADIUS_PX samples around them.

uniform usampler2D nearest;
out float out_occupied;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * TILE, last = textureSize(nearest, 0) - 1;
    uint closest = 0xFFFFFFFFu;
    for (int y = -RADIUS_PX; y < TILE + RADIUS_PX; ++y) {
        for (int x = -RADIUS_PX; x < TILE + RADIUS_PX; ++x) {
            ivec2 texel = clamp(corner + ivec2(x, y), ivec2(0), last);
            closest = min(closest, texelFetch(nearest, texel, 0).r);
        }
    }
    out_occupied = closest == 0xFFFFFFFFu ? 0.0 : 1.0;
}

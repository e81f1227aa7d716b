// Marks the tiles of the picture that hold splats. No splat is smaller than 1.5 REACH samples
// across, so that testing every REACH-th sample in both directions finds it.

uniform sampler2D color_sums;
out float out_occupied;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * TILE, last = textureSize(color_sums, 0) - 1;
    float weight = 0.0;
    for (int y = -REACH; y < TILE + REACH; y += REACH) {
        for (int x = -REACH; x < TILE + REACH; x += REACH) {
            weight += texelFetch(color_sums, clamp(corner + ivec2(x, y), ivec2(0), last), 0).a;
        }
    }
    out_occupied = weight > 0.0 ? 1.0 : 0.0;
}

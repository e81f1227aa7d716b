// Marks tiles of the picture that contain splats.

uniform sampler2D color_sums;
out float out_occupied;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * TILE, last = textureSize(color_sums, 0) - 1;
    float max_weight = 0.0;
    for (int i = 0; i < TILE * TILE; ++i) {
        ivec2 texel = min(corner + ivec2(i % TILE, i / TILE), last);
        max_weight = max(max_weight, texelFetch(color_sums, texel, 0).a);
    }
    out_occupied = max_weight > 0.0 ? 1.0 : 0.0;
}

// Marks tiles with points in them or within RADIUS_PX samples around them, after rows of tiles.
#if CODES
uniform usampler2D source;  // codes of points
#define IS_OCCUPIED(texel) (texel.r < 0xFFFFFFFFu)
#else
uniform sampler2D source;   // sums of splats, or marked rows of tiles
#define IS_OCCUPIED(texel) (texel.a > 0.0)
#endif
uniform ivec2 direction;    // (1, 0) for rows of tiles, (0, 1) for tiles
out vec4 out_occupied;

void main() {
    ivec2 start = ivec2(gl_FragCoord.xy) * (1 + (TILE - 1) * direction);
    bool occupied = false;
    for (int i = -RADIUS_PX; i < TILE + RADIUS_PX; ++i) {
        ivec2 at = clamp(start + i * direction, ivec2(0), textureSize(source, 0) - 1);
        occupied = occupied || IS_OCCUPIED(texelFetch(source, at, 0));
    }
    out_occupied = vec4(occupied);
}

// Draws each tile of the picture as two triangles; empty tiles are moved out of view.

uniform sampler2D occupied;  // 0 for tiles to skip (point_tiles.frag, splat_tiles.frag)
uniform ivec2 samples;       // width and height of the picture

void main() {
    int across = textureSize(occupied, 0).x, number = gl_VertexID / 6;
    int corner = int[](0, 1, 2, 2, 1, 3)[gl_VertexID % 6];
    ivec2 tile = ivec2(number % across, number / across);
    vec2 at = vec2(TILE * (tile + ivec2(corner & 1, corner >> 1))) / vec2(samples);
    bool visible = texelFetch(occupied, tile, 0).r > 0.0;
    gl_Position = visible ? vec4(2.0 * at - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}

// Draws each tile of the picture as a point; empty tiles are moved out of view.

uniform sampler2D occupied;  // 0 for tiles to skip (tiles.frag)
uniform float tile_px;       // side of a tile in pixels

void main() {
    ivec2 size = textureSize(occupied, 0), tile = ivec2(gl_VertexID % size.x, gl_VertexID / size.x);
    bool is_empty = texelFetch(occupied, tile, 0).r == 0.0;
    vec2 at = (vec2(tile) + 0.5) / vec2(size);
    gl_Position = is_empty ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(2.0 * at - 1.0, -1.0, 1.0);
    gl_PointSize = tile_px;
}

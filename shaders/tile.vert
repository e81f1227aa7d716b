// Draws tiles of the picture as points; empty tiles are moved out of view.

uniform sampler2D occupied;  // 0 for tiles to skip (tiles.frag)
uniform float tile_px;       // side of a tile in pixels
uniform ivec4 region;        // first tile, number of tiles across and down in the viewport

void main() {
    ivec2 tile = ivec2(gl_VertexID % region.z, gl_VertexID / region.z);
    bool is_empty = texelFetch(occupied, region.xy + tile, 0).r == 0.0;
    vec2 at = (vec2(tile) + 0.5) / vec2(region.zw);
    gl_Position = is_empty ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(2.0 * at - 1.0, -1.0, 1.0);
    gl_PointSize = tile_px;
}

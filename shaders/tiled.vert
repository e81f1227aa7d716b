// A tile that discs lie on, as a square point.
#version 330 core

in ivec4 in_tile;  // column, row, its first disc, how many
uniform vec2 tiles;
flat out ivec2 v_discs;

void main() {
    v_discs = in_tile.zw;
    gl_Position = vec4(2.0 * (vec2(in_tile.xy) + 0.5) / tiles - 1.0, 0.0, 1.0);
    gl_PointSize = float(TILE / SUPERSAMPLE);
}

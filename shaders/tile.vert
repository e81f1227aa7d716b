// A tile of the picture as a square point; empty tiles are moved out of view.

uniform sampler2D occupied;

void main() {
    ivec2 size = textureSize(occupied, 0);
    ivec2 tile = ivec2(gl_VertexID % size.x, gl_VertexID / size.x);
    vec2 middle = (vec2(tile) + 0.5) / vec2(size);
    bool seen = texelFetch(occupied, tile, 0).r > 0.0;
    gl_Position = seen ? vec4(2.0 * middle - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = float(TILE);
}

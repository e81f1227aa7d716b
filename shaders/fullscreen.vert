// One triangle that covers the picture, without vertex buffers.

out vec2 v_at;  // from (0, 0) at the bottom left to (1, 1) at the top right

void main() {
    v_at = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
    gl_Position = vec4(v_at * 2.0 - 1.0, -1.0, 1.0);
}

flat in vec2 v_cover;
out vec4 out_cover;

void main() {
    out_cover = vec4(v_cover, 0.0, 0.0);
}

// Writes the coverage of a point for the shadow.
flat in vec2 v_cover;
out vec2 out_cover;

void main() {
    out_cover = v_cover;
}

#version 330 core

flat in vec2 v_cover;
uniform float opacity;
out vec2 out_cover;

void main() {
    out_cover = v_cover * opacity;
}

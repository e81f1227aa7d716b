#version 330 core

void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    if (dot(at, at) > 1.0) {
        discard;
    }
}

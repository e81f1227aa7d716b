// Positions only, for transform feedback.
#version 330 core
#include "mover.glsl"

out vec3 out_position;

void main() {
    out_position = mover_position();
}

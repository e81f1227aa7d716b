// First pass: the depth of the nearest surface, set back by the discs' own thickness.
#version 330 core
#include "disc.glsl"

uniform float thickness;  // in disc radii

void main() {
    float world_radius;
    float away = place_disc(world_radius);
    vec4 behind = projection * vec4(0.0, 0.0, -(away + thickness * world_radius), 1.0);
    gl_Position.z = behind.z / behind.w * gl_Position.w;
}

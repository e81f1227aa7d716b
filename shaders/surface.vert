// First pass: the depth of the nearest surface, set back by the discs' own thickness.
#version 330 core
#include "disc.glsl"
#include "marks.glsl"

#if MARKED
in uint in_track;
#endif
uniform float thickness;  // in disc radii

void main() {
    float world_radius;
    float away = place_disc(world_radius);
    vec4 behind = projection * vec4(0.0, 0.0, -(away + thickness * world_radius), 1.0);
    gl_Position.z = behind.z / behind.w * gl_Position.w;
#if MARKED
    if (is_hidden(in_track)) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }
#endif
}

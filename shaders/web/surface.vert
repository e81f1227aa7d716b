// First pass: the depth of the nearest surface, set back by the discs' own thickness.

#include "disc.glsl"

uniform float thickness;  // in disc radii

void main() {
    vec2 disc = place_disc();
    vec4 behind = projection * vec4(0.0, 0.0, -(disc.x + thickness * disc.y), 1.0);
    gl_Position.z = behind.z / behind.w * gl_Position.w;
}

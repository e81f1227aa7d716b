// First pass over the splats: the depth of the nearest surface, set back by its own thickness.
#include "splat.glsl"
#include "splat_profile.glsl"

void main() {
    vec2 splat = place_splat();
    vec4 behind = projection * vec4(0.0, 0.0, -(splat.x + THICKNESS * splat.y), 1.0);
    gl_Position.z = behind.z / behind.w * gl_Position.w;
}

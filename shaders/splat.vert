// A splat, for all passes over splats.
#include "splat.glsl"
#include "point_color.glsl"

flat out vec3 v_color;
flat out vec3 v_depth;  // before the eye, of the middle; how it grows aside
flat out float v_radius;
flat out vec2 v_stretch;  // along it lengths grow by the factor 1 + stretch squared
flat out vec2 v_normal;
flat out uint v_track;

void main() {
    Splat splat = place_splat();
    v_color = point_color(IN_CURVE, in_track, in_start_color, in_end_color);
    v_depth = vec3(splat.depth, splat.radius * splat.slope);
    v_radius = splat.radius;
    v_stretch = splat.stretch;
    v_normal = splat.normal.xy;
    v_track = in_track;
}

// A splat, for all passes over splats.
#include "splat.glsl"
#include "point_color.glsl"

flat out vec3 v_color;
flat out vec3 v_depth;  // before the eye, of the middle; how it grows aside
flat out float v_radius;
flat out vec2 v_stretch;  // along it lengths grow by the factor 1 + stretch squared
flat out vec2 v_normal;
flat out uint v_track;

uniform float thickness;  // depth, in radii, over which splats count as one surface
uniform float span;       // share of the radius that the pass looks at
uniform float lift;       // 1: tested as near as a surface may begin that the splat is part of; else 0

void main() {
    Splat splat = place_splat();
    gl_PointSize *= span;
    float lifted = splat.depth - lift * splat.radius * (thickness + length(splat.slope));
    if (gl_Position.z > -gl_Position.w) {
        vec4 nearer = projection * vec4(0.0, 0.0, -max(lifted, 1e-3 * splat.depth), 1.0);
        gl_Position.z = gl_Position.w * max(nearer.z / nearer.w, -1.0);
    }
    v_color = point_color(IN_CURVE, in_track, in_start_color, in_end_color);
    v_depth = vec3(splat.depth, splat.radius * splat.slope);
    v_radius = splat.radius;
    v_stretch = splat.stretch;
    v_normal = splat.normal.xy;
    v_track = in_track;
}

// A splat, for all passes over splats.
#include "splat.glsl"
#include "point_color.glsl"

flat out vec3 v_color;
flat out vec3 v_depth;  // before the eye, of the middle; how it grows aside
flat out float v_radius;
flat out float v_span;  // half the point's side, in radii
flat out vec2 v_stretch;  // along it lengths grow by the factor 1 + stretch squared
flat out vec2 v_normal;
flat out uint v_track;

uniform float thickness;  // depth, in radii, over which splats count as one surface
uniform float span;       // distance from the centre, in radii, up to which the pass draws the splat
uniform float lift;       // 1 to test the nearest depth of a surface that the splat belongs to, else 0

// Half the side of the smallest square about the splat's ellipse, in radii.
float extent_of(Splat splat) {
    float shorter = 1.0 / (1.0 + dot(splat.stretch, splat.stretch));
    mat2 shape = mat2(1.0) - shorter * outerProduct(splat.stretch, splat.stretch);
    return max(length(shape[0]), length(shape[1]));
}

void main() {
    Splat splat = place_splat();
    v_span = span * extent_of(splat);
    gl_PointSize *= v_span;
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

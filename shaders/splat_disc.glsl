// Position and depth of a fragment in its splat.
#include "depth.glsl"

flat in vec3 v_depth;  // see splat.vert
flat in float v_radius;
flat in float v_span;
flat in vec2 v_stretch;

// In the projected disc, in radii.
vec2 position_in_point() {
    return v_span * (vec2(2.0, -2.0) * gl_PointCoord + vec2(-1.0, 1.0));
}

// In the plane of the disc, in radii, without foreshortening.
vec2 position_in_disc() {
    vec2 at = position_in_point();
    return at + dot(at, v_stretch) * v_stretch;
}

float depth_in_disc() {
    return v_depth.x + dot(v_depth.yz, position_in_point());
}

float depth_in_core() {
    vec2 at = position_in_disc();
    if (dot(at, at) > CORE * CORE) {
        discard;
    }
    return depth_in_disc();
}

// A point as a splat: the disc about its normal as the eye sees it, an ellipse; where its interval
// has no normals, a disc that faces the eye (Zwicker et al. 2001, "Surface splatting").
#include "point_attributes.glsl"
#include "depth.glsl"
#include "dissolve.glsl"
#include "point_color.glsl"

uniform mat4 view;
uniform mat4 projection;
uniform float lift;  // 1 to draw whole splats, and test the nearest depth of their surface; else 0

flat out vec3 v_color;
flat out vec3 v_depth;  // before the eye, of the middle; how much it grows aside in one radius
flat out float v_radius;  // in the clip's unit
flat out float v_span;  // half the point's side, in radii
flat out vec2 v_stretch;  // along it lengths grow by the factor 1 + stretch squared
flat out vec2 v_normal;  // in the eye's coordinates
flat out uint v_track;

// Limits for discs that are seen edge-on: half their width in samples, and their slope, because
// normals are not known more precisely.
const float THINNEST_PX = 0.75, STEEPEST = 2.5;

#if NORMALS
layout(location = 7) in vec4 in_normals;  // octahedral, at the interval's ends
uniform float turned;                     // share of the way from the one to the other

vec3 normal_of(vec2 code) {
    vec2 aside = vec2(code.x + code.y - 1.0, code.x - code.y);
    return normalize(vec3(aside, 1.0 - abs(aside.x) - abs(aside.y)));
}

// Towards the eye, in its coordinates. A plane has two sides: the end's is the nearer one.
vec3 normal_to_eye(vec3 ray) {
    vec3 start = normal_of(in_normals.xy), end = normal_of(in_normals.zw);
    vec3 normal = mat3(view) * mix(start, dot(start, end) < 0.0 ? -end : end, turned);
    return normalize(dot(normal, ray) > 0.0 ? -normal : normal);
}
#else
vec3 normal_to_eye(vec3 ray) {
    return vec3(0.0, 0.0, 1.0);
}
#endif

// Half the side of the smallest square about an ellipse, in radii.
float extent_of(vec2 stretch) {
    mat2 shape = mat2(1.0) - outerProduct(stretch, stretch) / (1.0 + dot(stretch, stretch));
    return max(length(shape[0]), length(shape[1]));
}

void main() {
    vec4 view_pos = view * vec4(point_position(), 1.0);
    float depth = -view_pos.z, px_per_unit = focal_px / max(clip_w(depth), 1e-6);
    float size = is_hidden(in_track) ? 0.0 : presence(gl_VertexID);
    float diameter = size * clamp(2.0 * radius * px_per_unit, point_px_range.x, point_px_range.y);
    v_radius = 0.5 * diameter / px_per_unit;

    vec3 ray = vec3(perspective * view_pos.xy / max(depth, 1e-6), -1.0);
    vec3 normal = normal_to_eye(ray);
    vec2 slope = normal.xy / max(-dot(normal, ray), 1e-3);  // how much deeper the disc gets aside
    vec2 along = slope / max(length(slope), 1e-6);
    slope = along * min(length(slope), min(STEEPEST, 0.5 * diameter / THINNEST_PX));
    v_stretch = along * sqrt(sqrt(1.0 + dot(slope, slope)) - 1.0);
    v_span = (lift > 0.0 ? RIM : CORE) * extent_of(v_stretch);

    gl_Position = size == 0.0 ? vec4(2.0, 2.0, 2.0, 1.0) : projection * view_pos;
    gl_PointSize = diameter * v_span;
    if (gl_Position.z > -gl_Position.w) {
        float lifted = depth - lift * v_radius * (THICKNESS + length(slope));
        vec4 nearer = projection * vec4(0.0, 0.0, -max(lifted, 1e-3 * depth), 1.0);
        gl_Position.z = gl_Position.w * max(nearer.z / nearer.w, -1.0);
    }
    v_color = point_color(IN_CURVE, in_track, in_start_color, in_end_color);
    v_depth = vec3(depth, v_radius * slope);
    v_normal = normal.xy;
    v_track = in_track;
}

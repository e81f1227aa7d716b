// Draws points as splats: discs perpendicular to their normals, which appear as ellipses, or discs
// that face the eye if the interval has no normals (Zwicker et al. 2001, "Surface splatting").
#include "point_attributes.glsl"
#include "depth.glsl"
#include "dissolve.glsl"
#include "point_color.glsl"

uniform mat4 view;
uniform mat4 projection;
uniform float lift;  // 1 to draw whole splats, moved forward by the thickness of a surface

flat out vec3 v_color;
flat out vec3 v_depth;  // depth of the centre, and its increase per radius right and up
flat out float v_radius;  // in the clip's unit
flat out float v_span;  // half the side of the point primitive, in radii
flat out vec2 v_stretch;  // distances in the disc are longer along it by 1 + its squared length
flat out vec2 v_normal;  // x and y in eye coordinates
flat out uint v_track;

// Limits for discs seen edge-on, since normals are not precise: half their width, and their slope.
const float MIN_HALF_WIDTH_PX = 0.75, MAX_SLOPE = 2.5;

#if NORMALS
layout(location = 7) in vec4 in_normals;  // octahedral coordinates at the interval's start and end
uniform float normal_share;               // weight of the normal at the end

vec3 normal_of(vec2 code) {
    vec2 lateral = vec2(code.x + code.y - 1.0, code.x - code.y);
    return normalize(vec3(lateral, 1.0 - abs(lateral.x) - abs(lateral.y)));
}

// The normal towards the eye, in eye coordinates. Normals of the clip have arbitrary signs.
vec3 normal_to_eye(vec3 ray) {
    vec3 start = normal_of(in_normals.xy), end = normal_of(in_normals.zw);
    vec3 normal = mat3(view) * mix(start, dot(start, end) < 0.0 ? -end : end, normal_share);
    return normalize(dot(normal, ray) > 0.0 ? -normal : normal);
}
#else
vec3 normal_to_eye(vec3 ray) {
    return vec3(0.0, 0.0, 1.0);
}
#endif

// Half the side of the bounding square of an ellipse, in radii.
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
    vec2 slope = normal.xy / max(-dot(normal, ray), 1e-3);  // increase of depth right and up
    vec2 along = slope / max(length(slope), 1e-6);
    slope = along * min(length(slope), min(MAX_SLOPE, 0.5 * diameter / MIN_HALF_WIDTH_PX));
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

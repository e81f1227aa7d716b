// A point as a splat: the disc about its normal as the eye sees it, an ellipse; where its interval
// has no normals, a disc that faces the eye (Zwicker et al. 2001, "Surface splatting").
#include "point_attributes.glsl"
#include "depth.glsl"
#include "dissolve.glsl"
#include "organ_flags.glsl"

uniform mat4 view;
uniform mat4 projection;
uniform float radius;         // of a splat, in the clip's unit
uniform float focal_px;       // pixels that one unit takes up where clip_w is 1
uniform vec2 point_px_range;  // diameters in pixels between which splats stay

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

// A disc that is seen from its edge stays an ellipse: half as wide in samples; as steep, because its
// normal is known as well as that.
const float THINNEST_PX = 0.75, STEEPEST = 2.5;

struct Splat {
    float depth;   // before the eye, in the clip's unit
    float radius;  // there, in the clip's unit
    vec3 normal;   // in the eye's coordinates
    vec2 slope;    // how much deeper it gets aside
    vec2 stretch;  // along it lengths grow by the factor 1 + stretch squared
};

// Place the splat, out of sight where its point is not to be seen.
Splat place_splat() {
    vec4 view_pos = view * vec4(point_position(), 1.0);
    Splat splat;
    splat.depth = -view_pos.z;
    float px_per_unit = focal_px / max(clip_w(splat.depth), 1e-6);
    float size = is_hidden(in_track) ? 0.0 : presence(gl_VertexID);
    gl_Position = size == 0.0 ? vec4(2.0, 2.0, 2.0, 1.0) : projection * view_pos;
    gl_PointSize = size * clamp(2.0 * radius * px_per_unit, point_px_range.x, point_px_range.y);
    splat.radius = 0.5 * gl_PointSize / px_per_unit;

    vec3 ray = vec3(perspective * view_pos.xy / max(splat.depth, 1e-6), -1.0);
    splat.normal = normal_to_eye(ray);
    vec2 slope = splat.normal.xy / max(-dot(splat.normal, ray), 1e-3);
    float steep = max(length(slope), 1e-6), most = min(STEEPEST, 0.5 * gl_PointSize / THINNEST_PX);
    splat.slope = slope * min(1.0, most / steep);
    float longer = sqrt(1.0 + dot(splat.slope, splat.slope)) - 1.0;
    splat.stretch = slope / steep * sqrt(longer);
    return splat;
}

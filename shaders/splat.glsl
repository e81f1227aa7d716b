// A point as a splat: a round disc, of a size in the world, that faces the eye.
#include "point_attributes.glsl"
#include "depth.glsl"
#include "dissolve.glsl"
#include "organ_flags.glsl"

uniform mat4 view;
uniform mat4 projection;
uniform float radius;         // of a splat, in the clip's unit
uniform float focal_px;       // pixels that one unit takes up where clip_w is 1
uniform vec2 point_px_range;  // diameters in pixels between which splats stay

// Place the splat, out of sight where its point is not to be seen; gives its depth before the eye
// and its radius there, in the clip's unit.
vec2 place_splat() {
    vec4 view_pos = view * vec4(point_position(), 1.0);
    float view_depth = -view_pos.z, px_per_unit = focal_px / max(clip_w(view_depth), 1e-6);
    float size = is_hidden(in_track) ? 0.0 : presence(gl_VertexID);
    gl_Position = size == 0.0 ? vec4(2.0, 2.0, 2.0, 1.0) : projection * view_pos;
    gl_PointSize = size * clamp(2.0 * radius * px_per_unit, point_px_range.x, point_px_range.y);
    return vec2(view_depth, 0.5 * gl_PointSize / px_per_unit);
}

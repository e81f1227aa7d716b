// Draws points as single samples as points.comp does, in OpenGL 3.3.
#include "point_attributes.glsl"
#include "nearest_point.glsl"
#include "dissolve.glsl"
#include "point_color.glsl"

flat out uint v_code;
flat out uint v_color;

void main() {
    ivec2 texel;
    bool visible = place_point(point_position(), in_track, texel, v_code) && !is_hidden(in_track)
             && presence(gl_VertexID) > 0.0;
    vec2 at = (vec2(texel) + 0.5) / vec2(samples);
    float depth = float(v_code / MAX_TRACKS) / DEPTH_STEPS;
    gl_Position = visible ? vec4(2.0 * at - 1.0, 2.0 * depth - 1.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
    v_color = packed_rgb(point_color(IN_CURVE, in_track, in_start_color, in_end_color));
}

// Movers as dots, one sample each, as dots.comp draws them: for OpenGL 3.3.
#version 330 core
#include "mover.glsl"
#include "dot.glsl"
#include "packed_light.glsl"
#include "light.glsl"

in uint in_track;
#if SCAN_COLORS
in vec4 in_start_color;
in vec4 in_end_color;
#endif

flat out uint v_number;
flat out uint v_light;

void main() {
    ivec2 texel;
    bool inside = place_dot(mover_position(), in_track, texel, v_number) && !is_hidden(in_track);
    vec2 at = (vec2(texel) + 0.5) / vec2(samples);
    float depth = float(v_number >> 10) / DEPTH_STEPS;
    gl_Position = inside ? vec4(2.0 * at - 1.0, 2.0 * depth - 1.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
#if VALUED == 1
    v_light = packed_light(set_back(value_light(height_value(mover_position())), in_track));
#elif VALUED == 2
    v_light = packed_light(set_back(value_light(speed_value(MOVER_POINTS)), in_track));
#elif SCAN_COLORS
    v_light = packed_light(mover_light(in_track, in_start_color, in_end_color));
#else
    v_light = packed_light(track_light(in_track));
#endif
}

// Second pass: the discs on the nearest surface, summed with weights that fall off to the rim.
// Surface splatting after Botsch et al. 2005, "High-quality surface splatting on today's GPUs".
#version 330 core
#include "disc.glsl"
#include "light.glsl"

in uint in_track;
#if SCAN_COLORS
in vec4 in_start_color;
in vec4 in_end_color;
#endif

flat out vec3 v_color;
flat out float v_away;

void main() {
    float world_radius;
    v_away = place_disc(world_radius);
    if (is_hidden(in_track)) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }
#if VALUED == 1
    v_color = set_back(value_light(height_value(mover_position())), in_track);
#elif VALUED == 2
    v_color = set_back(value_light(speed_value(MOVER_POINTS)), in_track);
#elif SCAN_COLORS
    v_color = mover_light(in_track, in_start_color, in_end_color);
#else
    v_color = track_light(in_track);
#endif
}

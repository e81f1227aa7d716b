// Movers as discs in the picture, into a buffer: to be sorted by the tiles that they cover.
#version 330 core
#include "mover.glsl"
#include "light.glsl"
#include "packed_light.glsl"

in uint in_track;
#if SCAN_COLORS
in vec4 in_start_color;
in vec4 in_end_color;
#endif
uniform mat4 view;
uniform vec2 focal;           // half the picture's size at distance 1, as OpenGL's projection has it
uniform vec2 samples;         // the picture's size
uniform vec2 depths;          // from the eye, of the nearest and the farthest that is seen

out vec3 out_disc;  // place in samples, distance from the eye; 0 where it is not seen
flat out uint out_light;

vec3 light_here() {
#if VALUED == 1
    return set_back(value_light(height_value(mover_position())), in_track);
#elif VALUED == 2
    return set_back(value_light(speed_value(MOVER_POINTS)), in_track);
#elif SCAN_COLORS
    return mover_light(in_track, in_start_color, in_end_color);
#else
    return track_light(in_track);
#endif
}

void main() {
    vec3 seen = (view * vec4(mover_position(), 1.0)).xyz;
    float away = -seen.z;
    bool there = away >= depths.x && away <= depths.y && !is_hidden(in_track);
    vec2 at = (seen.xy * focal / max(away, 1e-6) * 0.5 + 0.5) * samples;
    out_disc = there ? vec3(at, away) : vec3(0.0);
    out_light = packed_light(light_here());
}

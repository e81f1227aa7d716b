// Second pass: the discs on the nearest surface, summed with weights that fall off to the rim.
// Surface splatting after Botsch et al. 2005, "High-quality surface splatting on today's GPUs".
#version 330 core
#include "disc.glsl"
#include "srgb.glsl"

in uint in_track;
#if SCAN_COLORS
in vec4 in_start_color;
in vec4 in_end_color;
uniform bool by_track;
uniform float blend;  // share of the end's colour
#endif
uniform sampler2D palette;

flat out vec3 v_color;
flat out float v_away;

vec3 track_color() {
    int width = textureSize(palette, 0).x;
    int id = int(in_track);
    return srgb_to_linear(texelFetch(palette, ivec2(id % width, id / width), 0).rgb);
}

void main() {
    float world_radius;
    v_away = place_disc(world_radius);
#if SCAN_COLORS
    vec3 scanned = mix(srgb_to_linear(in_start_color.rgb), srgb_to_linear(in_end_color.rgb), blend);
    v_color = by_track ? track_color() : scanned;
#else
    v_color = track_color();
#endif
}

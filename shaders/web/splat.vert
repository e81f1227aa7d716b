// Second pass: the discs on the nearest surface, summed with weights that fall off to the rim.
// Surface splatting after Botsch et al. 2005, "High-quality surface splatting on today's GPUs".

#include "disc.glsl"
#include "../color.glsl"

layout(location = 4) in uint in_track;
#if SCAN_COLORS
layout(location = 5) in vec3 in_start_color;
layout(location = 6) in vec3 in_end_color;
uniform bool by_track;
uniform float blend;  // share of the end's colour
#endif
uniform sampler2D palette;
uniform int chosen;   // the track that stands out, -1 for none
uniform float scale;  // radius of the scene
uniform float middle; // distance of the camera's target

flat out vec3 v_color;
flat out float v_away;  // in scene radii beyond the target: half floats hold it finely

void main() {
    float away = place_disc().x;
    int id = int(in_track), width = textureSize(palette, 0).x;
    v_color = srgb_to_linear(texelFetch(palette, ivec2(id % width, id / width), 0).rgb);
#if SCAN_COLORS
    if (!by_track) {
        v_color = mix(srgb_to_linear(in_start_color), srgb_to_linear(in_end_color), blend);
    }
#endif
    if (chosen >= 0 && chosen != id) {
        v_color = mix(vec3(dot(v_color, vec3(0.2126, 0.7152, 0.0722))), v_color, 0.15) * 0.45;
    }
    v_away = (away - middle) / scale;
}

// A mover's colour, in linear light.
#include "srgb.glsl"
#include "marks.glsl"
#include "value.glsl"

uniform sampler2D palette;  // the tracks' colours, in linear light
#if SCAN_COLORS
uniform bool by_track;
uniform float blend;        // share of the end's colour
#endif

vec3 track_light(uint track) {
    int width = textureSize(palette, 0).x, id = int(track);
    return texelFetch(palette, ivec2(id % width, id / width), 0).rgb;
}

#if SCAN_COLORS
vec3 mover_light(uint track, vec4 start_color, vec4 end_color) {
    if (by_track) {
        return track_light(track);
    }
    vec3 start = srgb_to_linear(start_color.rgb), end = srgb_to_linear(end_color.rgb);
    return set_back(mix(start, end, blend), track);
}
#endif

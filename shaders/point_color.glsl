// Colour of a point in linear light, by its organ, by the scans or by a scalar field.
#include "color.glsl"
#include "organ_flags.glsl"
#include "scalar_field.glsl"

#if SCAN_COLORS
uniform bool by_track;  // use the organ's colour although there are scan colours
uniform float blend;    // weight of the colour at the interval's end
#endif

// start, end: sRGB colours at the interval's start and end, unused without scan colours.
vec3 point_color(vec3 curve[DEGREE + 1], uint track, vec4 start, vec4 end) {
#ifdef SCALAR_FIELD
    return dimmed(scalar_color(curve), track);
#elif SCAN_COLORS
    if (!by_track) {
        return dimmed(mix(srgb_to_linear(start.rgb), srgb_to_linear(end.rgb), blend), track);
    }
#endif
    return organ_texel(track).rgb;
}

// A point's colour, in linear light: its organ's, its scans', or a scalar field's.
#include "color.glsl"
#include "organ_flags.glsl"
#include "scalar_field.glsl"

#if SCAN_COLORS
uniform bool by_track;  // the organ's, although there are scan colours
uniform float blend;    // share of the end's colour
#endif

// start, end: sRGB at the interval's ends, where there are scan colours.
vec3 point_color(vec3 curve[DEGREE + 1], uint track, vec4 start, vec4 end) {
#if SCALAR_FIELD
    return dimmed(scalar_color(curve), track);
#elif SCAN_COLORS
    if (!by_track) {
        return dimmed(mix(srgb_to_linear(start.rgb), srgb_to_linear(end.rgb), blend), track);
    }
#endif
    return organ_texel(track).rgb;
}

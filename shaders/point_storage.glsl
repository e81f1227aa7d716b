// Points in storage buffers, for compute shaders; bindings: the locations of point_attributes.glsl.
// Points are read in groups of four: only four quantised positions of 3 x 16 bits fill words of 64
// bits.
#include "interpolate.glsl"

#if QUANTISED
#define WORDS 3  // words of 64 bits for four positions
#else
#define WORDS 6
#endif

layout(std430, binding = 0) readonly buffer Points { uvec2 words[]; } stored_points[DEGREE + 1];
layout(std430, binding = 4) readonly buffer Tracks { uint stored_track[]; };
#if SCAN_COLORS
layout(std430, binding = 5) readonly buffer StartColors { uint stored_start_color[]; };
layout(std430, binding = 6) readonly buffer EndColors { uint stored_end_color[]; };
#endif

#if QUANTISED
vec3 first_of(uvec3 words) {
    return vec3(ivec3(words.x & 0xFFFFu, words.x >> 16, words.y & 0xFFFFu));
}
vec3 second_of(uvec3 words) {
    return vec3(ivec3(words.y >> 16, words.z & 0xFFFFu, words.z >> 16));
}
vec3[4] unpacked(uvec2 w[WORDS]) {
    return vec3[](first_of(uvec3(w[0], w[1].x)), second_of(uvec3(w[0], w[1].x)),
                  first_of(uvec3(w[1].y, w[2])), second_of(uvec3(w[1].y, w[2])));
}
#else
vec3[4] unpacked(uvec2 w[WORDS]) {
    return vec3[](uintBitsToFloat(uvec3(w[0], w[1].x)), uintBitsToFloat(uvec3(w[1].y, w[2])),
                  uintBitsToFloat(uvec3(w[3], w[4].x)), uintBitsToFloat(uvec3(w[4].y, w[5])));
}
#endif

// Control points of four curves; curves beyond the last point are undefined.
struct Curves {
    vec3 points[DEGREE + 1][4];
};

Curves stored_curves(uint group) {
    Curves curves;
    for (int k = 0; k <= DEGREE; ++k) {
        uvec2 words[WORDS];
        for (uint i = 0u; i < uint(WORDS); ++i) {
            words[i] = stored_points[k].words[group * uint(WORDS) + i];
        }
        curves.points[k] = unpacked(words);
    }
    return curves;
}

vec3[DEGREE + 1] curve_of(Curves curves, int i) {
    vec3 curve[DEGREE + 1];
    for (int k = 0; k <= DEGREE; ++k) {
        curve[k] = curves.points[k][i];
    }
    return curve;
}

uint[4] stored_tracks(uint group) {
#if WIDE_TRACKS
    return uint[](stored_track[4u * group], stored_track[4u * group + 1u],
                  stored_track[4u * group + 2u], stored_track[4u * group + 3u]);
#else
    uint low = stored_track[2u * group], high = stored_track[2u * group + 1u];
    return uint[](low & 0xFFFFu, low >> 16, high & 0xFFFFu, high >> 16);
#endif
}

#if SCAN_COLORS
vec4 stored_start(int point) { return unpackUnorm4x8(stored_start_color[point]); }
vec4 stored_end(int point) { return unpackUnorm4x8(stored_end_color[point]); }
#else
vec4 stored_start(int point) { return vec4(0.0); }
vec4 stored_end(int point) { return vec4(0.0); }
#endif

// Points in storage buffers, for compute shaders; bindings: the locations of point_attributes.glsl.
// Points are read in groups of eight: only eight quantised positions of 3 x 16 bits fill words of
// 128 bits, and a wide word takes about as long to read as a narrow one.
#include "interpolate.glsl"

#if QUANTISED
#define WORDS 3  // words of 128 bits for eight positions
#else
#define WORDS 6
#endif

layout(std430, binding = 0) readonly buffer Points { uvec4 words[]; } stored_points[DEGREE + 1];
layout(std430, binding = 4) readonly buffer Tracks { uvec4 stored_track[]; };
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
vec3[8] unpacked(uvec4 w[WORDS]) {
    uvec3 a = w[0].xyz, b = uvec3(w[0].w, w[1].xy), c = uvec3(w[1].zw, w[2].x), d = w[2].yzw;
    return vec3[](first_of(a), second_of(a), first_of(b), second_of(b),
                  first_of(c), second_of(c), first_of(d), second_of(d));
}
#else
vec3[8] unpacked(uvec4 w[WORDS]) {
    return vec3[](uintBitsToFloat(w[0].xyz), uintBitsToFloat(uvec3(w[0].w, w[1].xy)),
                  uintBitsToFloat(uvec3(w[1].zw, w[2].x)), uintBitsToFloat(w[2].yzw),
                  uintBitsToFloat(w[3].xyz), uintBitsToFloat(uvec3(w[3].w, w[4].xy)),
                  uintBitsToFloat(uvec3(w[4].zw, w[5].x)), uintBitsToFloat(w[5].yzw));
}
#endif

// Control points of eight curves; curves beyond the last point are undefined.
struct Curves {
    vec3 points[DEGREE + 1][8];
};

Curves stored_curves(uint group) {
    Curves curves;
    for (int k = 0; k <= DEGREE; ++k) {
        uvec4 words[WORDS];
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

uint[8] stored_tracks(uint group) {
#if WIDE_TRACKS
    uvec4 a = stored_track[2u * group], b = stored_track[2u * group + 1u];
    return uint[](a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w);
#else
    uvec4 a = stored_track[group], low = a & 0xFFFFu, high = a >> 16;
    return uint[](low.x, high.x, low.y, high.y, low.z, high.z, low.w, high.w);
#endif
}

#if SCAN_COLORS
vec4 stored_start(int point) { return unpackUnorm4x8(stored_start_color[point]); }
vec4 stored_end(int point) { return unpackUnorm4x8(stored_end_color[point]); }
#else
vec4 stored_start(int point) { return vec4(0.0); }
vec4 stored_end(int point) { return vec4(0.0); }
#endif

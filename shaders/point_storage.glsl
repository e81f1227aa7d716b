// Points in storage buffers, for compute shaders; bindings: the locations of point_attributes.glsl.
// Points are read in groups of eight: only eight quantised positions of 3 x 16 bits fill words of
// 128 bits, and a wide word takes about as long to read as a narrow one.
#include "interpolate.glsl"

#if QUANTISED
#define WORDS 3  // words of 128 bits for eight positions
#else
#define WORDS 6
#endif
#define TRACK_WORDS (1 + WIDE_TRACKS)

layout(std430, binding = 0) readonly buffer Points { uvec4 words[]; } stored_points[DEGREE + 1];
layout(std430, binding = 4) readonly buffer Tracks { uvec4 stored_track[]; };
#if SCAN_COLORS
layout(std430, binding = 5) readonly buffer StartColors { uint stored_start_color[]; };
layout(std430, binding = 6) readonly buffer EndColors { uint stored_end_color[]; };
#endif

// Eight movers as they are stored. Unpacked one after the other, they take fewer registers.
struct Movers {
    uvec4 curves[DEGREE + 1][WORDS];
    uvec4 tracks[TRACK_WORDS];
};

Movers stored_movers(uint group) {
    Movers movers;
    for (uint i = 0u; i < uint(WORDS); ++i) {
        for (int k = 0; k <= DEGREE; ++k) {
            movers.curves[k][i] = stored_points[k].words[group * uint(WORDS) + i];
        }
    }
    for (uint i = 0u; i < uint(TRACK_WORDS); ++i) {
        movers.tracks[i] = stored_track[group * uint(TRACK_WORDS) + i];
    }
    return movers;
}

// One of eight positions; `i` is a constant.
vec3 unpacked(uvec4 w[WORDS], int i) {
#if QUANTISED
    uvec3 pairs[4] = uvec3[](w[0].xyz, uvec3(w[0].w, w[1].xy), uvec3(w[1].zw, w[2].x), w[2].yzw);
    uvec3 pair = pairs[i / 2], low = pair & 0xFFFFu, high = pair >> 16;
    return vec3(ivec3(i % 2 == 0 ? uvec3(low.x, high.x, low.y) : uvec3(high.y, low.z, high.z)));
#else
    return uintBitsToFloat(uvec3(w[3 * i / 4][3 * i % 4], w[(3 * i + 1) / 4][(3 * i + 1) % 4],
                                 w[(3 * i + 2) / 4][(3 * i + 2) % 4]));
#endif
}

vec3[DEGREE + 1] curve_of(Movers movers, int i) {
    vec3 curve[DEGREE + 1];
    for (int k = 0; k <= DEGREE; ++k) {
        curve[k] = unpacked(movers.curves[k], i);
    }
    return curve;
}

uint track_of(Movers movers, int i) {
#if WIDE_TRACKS
    return movers.tracks[i / 4][i % 4];
#else
    return movers.tracks[0][i / 2] >> (16 * (i % 2)) & 0xFFFFu;
#endif
}

#if SCAN_COLORS
vec4 stored_start(int point) { return unpackUnorm4x8(stored_start_color[point]); }
vec4 stored_end(int point) { return unpackUnorm4x8(stored_end_color[point]); }
#else
vec4 stored_start(int point) { return vec4(0.0); }
vec4 stored_end(int point) { return vec4(0.0); }
#endif

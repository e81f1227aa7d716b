// Four movers at a time from storage buffers, for compute shaders.
//
// A quantised position is three 16-bit numbers, so four of them are three numbers of 64 bits: read
// as doubles, which every OpenGL that has compute shaders has, and never computed with. It takes
// half as many reads as words do. The bindings are those of player/chunks.py.

#include "curve.glsl"

layout(std430, binding = 0) readonly buffer Points0 { double stored_point0[]; };
#if DEGREE > 0
layout(std430, binding = 1) readonly buffer Points1 { double stored_point1[]; };
#endif
#if DEGREE > 1
layout(std430, binding = 2) readonly buffer Points2 { double stored_point2[]; };
#endif
#if DEGREE > 2
layout(std430, binding = 3) readonly buffer Points3 { double stored_point3[]; };
#endif
layout(std430, binding = 4) readonly buffer Tracks { uint stored_track[]; };
#if SCAN_COLORS
layout(std430, binding = 5) readonly buffer StartColors { uint stored_start_color[]; };
layout(std430, binding = 6) readonly buffer EndColors { uint stored_end_color[]; };
#endif

#define WORDS(stored, at) unpackDouble2x32(stored[at])

#if QUANTISED
vec3 first_of(uvec3 words) {
    return vec3(ivec3(words.x & 0xFFFFu, words.x >> 16, words.y & 0xFFFFu));
}
vec3 second_of(uvec3 words) {
    return vec3(ivec3(words.y >> 16, words.z & 0xFFFFu, words.z >> 16));
}
vec3[4] unpacked(uvec2 a, uvec2 b, uvec2 c) {
    return vec3[](first_of(uvec3(a, b.x)), second_of(uvec3(a, b.x)),
                  first_of(uvec3(b.y, c)), second_of(uvec3(b.y, c)));
}
#define READ(stored, four) unpacked(WORDS(stored, 3u * (four)), WORDS(stored, 3u * (four) + 1u), \
                                    WORDS(stored, 3u * (four) + 2u))
#else
vec3[4] unpacked(uvec2 a, uvec2 b, uvec2 c, uvec2 d, uvec2 e, uvec2 f) {
    return vec3[](uintBitsToFloat(uvec3(a, b.x)), uintBitsToFloat(uvec3(b.y, c)),
                  uintBitsToFloat(uvec3(d, e.x)), uintBitsToFloat(uvec3(e.y, f)));
}
#define READ(stored, four) unpacked(WORDS(stored, 6u * (four)), WORDS(stored, 6u * (four) + 1u), \
                                    WORDS(stored, 6u * (four) + 2u), WORDS(stored, 6u * (four) + 3u), \
                                    WORDS(stored, 6u * (four) + 4u), WORDS(stored, 6u * (four) + 5u))
#endif

// The points of four movers' curves; those beyond the last mover mean nothing.
struct Curves {
    vec3 point0[4];
#if DEGREE > 0
    vec3 point1[4];
#endif
#if DEGREE > 1
    vec3 point2[4];
#endif
#if DEGREE > 2
    vec3 point3[4];
#endif
};

Curves stored_curves(uint four) {
    Curves curves;
    curves.point0 = READ(stored_point0, four);
#if DEGREE > 0
    curves.point1 = READ(stored_point1, four);
#endif
#if DEGREE > 1
    curves.point2 = READ(stored_point2, four);
#endif
#if DEGREE > 2
    curves.point3 = READ(stored_point3, four);
#endif
    return curves;
}

vec3[DEGREE + 1] points_of(Curves curves, uint i) {
#if DEGREE == 0
    return vec3[](curves.point0[i]);
#elif DEGREE == 1
    return vec3[](curves.point0[i], curves.point1[i]);
#elif DEGREE == 2
    return vec3[](curves.point0[i], curves.point1[i], curves.point2[i]);
#else
    return vec3[](curves.point0[i], curves.point1[i], curves.point2[i], curves.point3[i]);
#endif
}

uint[4] stored_tracks(uint four) {
#if WIDE_TRACKS
    return uint[](stored_track[4u * four], stored_track[4u * four + 1u],
                  stored_track[4u * four + 2u], stored_track[4u * four + 3u]);
#else
    uint low = stored_track[2u * four], high = stored_track[2u * four + 1u];
    return uint[](low & 0xFFFFu, low >> 16, high & 0xFFFFu, high >> 16);
#endif
}

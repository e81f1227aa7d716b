// Two movers at a time from storage buffers, for compute shaders.
//
// A quantised position is three 16-bit numbers, so two of them are three whole words. The bindings
// are those of player/chunks.py.

#include "curve.glsl"

layout(std430, binding = 0) readonly buffer Points0 { uint stored_point0[]; };
#if DEGREE > 0
layout(std430, binding = 1) readonly buffer Points1 { uint stored_point1[]; };
#endif
#if DEGREE > 1
layout(std430, binding = 2) readonly buffer Points2 { uint stored_point2[]; };
#endif
#if DEGREE > 2
layout(std430, binding = 3) readonly buffer Points3 { uint stored_point3[]; };
#endif
layout(std430, binding = 4) readonly buffer Tracks { uint stored_track[]; };
#if SCAN_COLORS
layout(std430, binding = 5) readonly buffer StartColors { uint stored_start_color[]; };
layout(std430, binding = 6) readonly buffer EndColors { uint stored_end_color[]; };
#endif

#if QUANTISED
#define WORDS 3u
vec3 first_of(uvec3 words) {
    return vec3(words.x & 0xFFFFu, words.x >> 16, words.y & 0xFFFFu);
}
vec3 second_of(uvec3 words) {
    return vec3(words.y >> 16, words.z & 0xFFFFu, words.z >> 16);
}
#define READ(stored, at) uvec3(stored[at], stored[at + 1u], stored[at + 2u])
#define FIRST(stored, at) first_of(READ(stored, at))
#define SECOND(stored, at) second_of(READ(stored, at))
#else
#define WORDS 6u
#define READ(stored, at) uintBitsToFloat(uvec3(stored[at], stored[at + 1u], stored[at + 2u]))
#define FIRST(stored, at) READ(stored, at)
#define SECOND(stored, at) READ(stored, at + 3u)
#endif

// Positions of movers 2 * pair and 2 * pair + 1; there may be no second one.
void mover_positions(uint pair, out vec3 first, out vec3 second) {
    uint at = WORDS * pair;
#if DEGREE == 0
    first = on_curve(vec3[](FIRST(stored_point0, at)));
    second = on_curve(vec3[](SECOND(stored_point0, at)));
#elif DEGREE == 1
    first = on_curve(vec3[](FIRST(stored_point0, at), FIRST(stored_point1, at)));
    second = on_curve(vec3[](SECOND(stored_point0, at), SECOND(stored_point1, at)));
#elif DEGREE == 2
    first = on_curve(vec3[](FIRST(stored_point0, at), FIRST(stored_point1, at),
                            FIRST(stored_point2, at)));
    second = on_curve(vec3[](SECOND(stored_point0, at), SECOND(stored_point1, at),
                             SECOND(stored_point2, at)));
#else
    first = on_curve(vec3[](FIRST(stored_point0, at), FIRST(stored_point1, at),
                            FIRST(stored_point2, at), FIRST(stored_point3, at)));
    second = on_curve(vec3[](SECOND(stored_point0, at), SECOND(stored_point1, at),
                             SECOND(stored_point2, at), SECOND(stored_point3, at)));
#endif
}

// The points of one mover's curve, as numbers of steps.
#define ONE(stored, mover) ((mover & 1u) == 0u ? FIRST(stored, WORDS * (mover >> 1)) \
                                               : SECOND(stored, WORDS * (mover >> 1)))
#if DEGREE == 0
#define MOVER_POINTS(mover) vec3[](ONE(stored_point0, mover))
#elif DEGREE == 1
#define MOVER_POINTS(mover) vec3[](ONE(stored_point0, mover), ONE(stored_point1, mover))
#elif DEGREE == 2
#define MOVER_POINTS(mover) vec3[](ONE(stored_point0, mover), ONE(stored_point1, mover), \
                                   ONE(stored_point2, mover))
#else
#define MOVER_POINTS(mover) vec3[](ONE(stored_point0, mover), ONE(stored_point1, mover), \
                                   ONE(stored_point2, mover), ONE(stored_point3, mover))
#endif

uvec2 mover_tracks(uint pair) {
#if WIDE_TRACKS
    return uvec2(stored_track[2u * pair], stored_track[2u * pair + 1u]);
#else
    return uvec2(stored_track[pair] & 0xFFFFu, stored_track[pair] >> 16);
#endif
}

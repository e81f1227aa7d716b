// Closes the surface between dots: every dot is a soft disc on the samples around it, and of those
// on the nearest surface the weighted mean is what is seen. So the picture is that of the splats
// (splat.vert), centres rounded to whole samples, at a cost that the movers' number doesn't change.
// A pixel's samples see much the same dots: each is read once for all of them.
#version 330 core
#include "dot.glsl"
#include "packed_light.glsl"
#include "leave.glsl"

// BY_SEGMENT: the ten bits name the colour.

uniform usampler2D nearest;
uniform usampler2D picked;
uniform sampler2D palette;
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;  // samples that one unit takes up at distance 1
uniform float smallest;       // diameter in samples
uniform float thickness;      // in disc radii

const int SIDE = 2 * REACH + SUPERSAMPLE;
const float NOWHERE = 1e30;

float least, scaled;  // of a disc's radius, in samples: at least so much, and at distance 1
float surface[S];     // the nearest one that hides what is behind it
float away_sums[S];
vec4 sums[S];

uint number_at(ivec2 texel) {
    return texelFetch(nearest, clamp(texel, ivec2(0), samples - 1), 0).r;
}

vec3 light_of(uint number, ivec2 texel) {
#if BY_SEGMENT
    return texelFetch(palette, ivec2(number & 1023u, 0), 0).rgb;
#else
    return unpacked_light(texelFetch(picked, clamp(texel, ivec2(0), samples - 1), 0).r);
#endif
}

// A dot may lie anywhere in its sample: half a sample more is where its disc can reach.
float reach_of(float away) {
    return max(scaled / away, least) + 0.5;
}

void hide_behind(uint number, ivec2 place) {
    float away = dot_distance(number), reach = reach_of(away);
    float core = number == EMPTY ? -1.0 : CORE * CORE * reach * reach;
    float behind = away + thickness * (reach - 0.5) * away / magnification;
    for (int i = 0; i < S; ++i) {
        ivec2 aside = place - place_of(i);
        if (abs(aside.x) <= REACH && abs(aside.y) <= REACH) {
            bool hides = float(aside.x * aside.x + aside.y * aside.y) <= core;
            surface[i] = hides ? min(surface[i], behind) : surface[i];
        }
    }
}

void add(uint number, ivec2 place, vec3 light) {
    float away = dot_distance(number), reach = reach_of(away), fall = 1.0 / (reach * reach);
    for (int i = 0; i < S; ++i) {
        ivec2 aside = place - place_of(i);
        if (abs(aside.x) <= REACH && abs(aside.y) <= REACH) {
            float rise = max(1.0 - float(aside.x * aside.x + aside.y * aside.y) * fall, 0.0);
            float weight = number == EMPTY || away > surface[i] ? 0.0 : rise * rise;
            sums[i] += vec4(light, 1.0) * weight;
            away_sums[i] += away * weight;
        }
    }
}

// All places that matter, written out: no compiler unrolls a loop of 36, and without that arrays
// lie in memory, which makes this three times as slow.
#if SUPERSAMPLE + 2 * REACH == 6
#define ROW(f, y) f(0, y) f(1, y) f(2, y) f(3, y) f(4, y) f(5, y)
#define ALL(f) ROW(f, 0) ROW(f, 1) ROW(f, 2) ROW(f, 3) ROW(f, 4) ROW(f, 5)
#elif SUPERSAMPLE + 2 * REACH == 5
#define ROW(f, y) f(0, y) f(1, y) f(2, y) f(3, y) f(4, y)
#define ALL(f) ROW(f, 0) ROW(f, 1) ROW(f, 2) ROW(f, 3) ROW(f, 4)
#elif SUPERSAMPLE + 2 * REACH == 4
#define ROW(f, y) f(0, y) f(1, y) f(2, y) f(3, y)
#define ALL(f) ROW(f, 0) ROW(f, 1) ROW(f, 2) ROW(f, 3)
#else
#define ROW(f, y) f(0, y) f(1, y) f(2, y)
#define ALL(f) ROW(f, 0) ROW(f, 1) ROW(f, 2)
#endif
#define READ(x, y) numbers[y * SIDE + x] = number_at(corner + ivec2(x, y));
#define HIDE(x, y) hide_behind(numbers[y * SIDE + x], ivec2(x, y) - REACH);
#define ADD(x, y) add(numbers[y * SIDE + x], ivec2(x, y) - REACH, \
                      light_of(numbers[y * SIDE + x], corner + ivec2(x, y)));

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * SUPERSAMPLE - REACH;
    least = 0.5 * smallest;
    scaled = radius * magnification;
    for (int i = 0; i < S; ++i) {
        surface[i] = NOWHERE;
        away_sums[i] = 0.0;
        sums[i] = vec4(0.0);
    }
    uint numbers[SIDE * SIDE];
    ALL(READ)
    ALL(HIDE)
    ALL(ADD)
    leave(sums, away_sums);
}

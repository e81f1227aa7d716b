// Closes the surface between dots: every dot is a soft disc on the samples around it, and of those
// on the nearest surface the weighted mean is what is seen. So the picture is that of the splats
// (splat.vert), centres rounded to whole samples, at a cost that the movers' number doesn't change.
#version 330 core
#include "dot.glsl"

// BY_SEGMENT: the ten bits name the colour.

uniform usampler2D nearest;
uniform usampler2D picked;
uniform sampler2D palette;
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;  // samples that one unit takes up at distance 1
uniform float smallest;       // diameter in samples
uniform float thickness;      // in disc radii

layout(location = 0) out vec4 out_color;  // linear light times weight, weight
layout(location = 1) out float out_away;  // mean distance, negative where there is nothing

const int SIDE = 2 * REACH + 1;

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

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float least = 0.5 * smallest, scaled = radius * magnification;
    uint numbers[SIDE * SIDE];
    float surface = 1e30;
    for (int i = 0; i < SIDE * SIDE; ++i) {
        ivec2 aside = ivec2(i % SIDE, i / SIDE) - REACH;
        uint number = number_at(texel + aside);
        numbers[i] = number;
        float away = dot_distance(number);
        float reach = max(scaled / away, least);
        // A dot may lie anywhere in its sample: half a sample more is where its disc can reach.
        float core = CORE * (reach + 0.5);
        bool hides = number != EMPTY && float(aside.x * aside.x + aside.y * aside.y) <= core * core;
        surface = hides ? min(surface, away + thickness * reach * away / magnification) : surface;
    }
    float away_sum = 0.0;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < SIDE * SIDE; ++i) {
        ivec2 aside = ivec2(i % SIDE, i / SIDE) - REACH;
        uint number = numbers[i];
        float away = dot_distance(number);
        float reach = max(scaled / away, least) + 0.5;
        float rise = 1.0 - float(aside.x * aside.x + aside.y * aside.y) / (reach * reach);
        float weight = number == EMPTY || away > surface ? 0.0 : max(rise, 0.0) * max(rise, 0.0);
        sum += vec4(light_of(number, texel + aside), 1.0) * weight;
        away_sum += away * weight;
    }
    bool here = sum.a > RIM_OUTSIDE;
    out_color = sum;
    out_away = here ? away_sum / sum.a : -1.0;
    gl_FragDepth = here ? 0.0 : 1.0;
}

// Closes the surface between dots: every dot is a soft disc on the samples around it, and of those
// on the nearest surface the weighted mean is what is seen. So the picture is that of the splats
// (splat.vert), centres rounded to whole samples, at a cost that the movers' number doesn't change.
#version 330 core
#include "dot.glsl"

uniform usampler2D nearest;
uniform usampler2D picked;
uniform sampler2D palette;
uniform bool by_segment;      // the ten bits name the colour
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

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    out_color = vec4(0.0);
    out_away = -1.0;
    gl_FragDepth = 1.0;
    uint closest = EMPTY;
    for (int i = 0; i < SIDE * SIDE; ++i) {
        closest = min(closest, number_at(texel + ivec2(i % SIDE, i / SIDE) - REACH));
    }
    if (closest == EMPTY) {
        return;
    }
    // A dot may lie anywhere in its sample: half a sample more is where its disc can reach.
    float least = 0.5 * smallest, scaled = radius * magnification;
    float surface = 1e30;
    for (int i = 0; i < SIDE * SIDE; ++i) {
        ivec2 aside = ivec2(i % SIDE, i / SIDE) - REACH;
        uint number = number_at(texel + aside);
        float away = dot_distance(number);
        float reach = max(scaled / away, least);
        float core = CORE * (reach + 0.5);
        if (number != EMPTY && float(aside.x * aside.x + aside.y * aside.y) <= core * core) {
            surface = min(surface, away + thickness * reach * away / magnification);
        }
    }
    float away_sum = 0.0;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < SIDE * SIDE; ++i) {
        ivec2 aside = ivec2(i % SIDE, i / SIDE) - REACH;
        uint number = number_at(texel + aside);
        float away = dot_distance(number);
        float reach = max(scaled / away, least) + 0.5;
        float rise = 1.0 - float(aside.x * aside.x + aside.y * aside.y) / (reach * reach);
        if (number == EMPTY || away > surface || rise <= 0.0) {
            continue;
        }
        vec3 light = by_segment
            ? texelFetch(palette, ivec2(number & 1023u, 0), 0).rgb
            : unpacked_light(texelFetch(picked, clamp(texel + aside, ivec2(0), samples - 1), 0).r);
        float weight = rise * rise;
        sum += vec4(light, 1.0) * weight;
        away_sum += away * weight;
    }
    if (sum.a > RIM_OUTSIDE) {
        out_color = sum;
        out_away = away_sum / sum.a;
        gl_FragDepth = 0.0;
    }
}

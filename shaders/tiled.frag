// The splats' picture (splat.vert), each sample asking for the discs that its tile has: on a CPU
// many times as fast as blending disc after disc into the picture. They come nearest first, so the
// first one whose core a sample lies in tells where its surface is.
#version 330 core
#include "leave.glsl"
#include "packed_light.glsl"

flat in ivec2 v_discs;
uniform usampler2D discs;     // as discs.vert leaves them, tile by tile
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;  // samples that one unit takes up at distance 1
uniform float smallest;       // diameter in samples
uniform float thickness;      // in disc radii

void main() {
    vec2 first = gl_FragCoord.xy * float(SUPERSAMPLE) - 0.5 * float(SUPERSAMPLE - 1);
    float surface[S], away_sums[S];
    vec4 sums[S];
    for (int i = 0; i < S; ++i) {
        surface[i] = 1e30;
        away_sums[i] = 0.0;
        sums[i] = vec4(0.0);
    }
    float scaled = radius * magnification, least = 0.5 * smallest;
    for (int number = v_discs.x; number < v_discs.x + v_discs.y; ++number) {
        uvec4 stored = texelFetch(discs, ivec2(number & (WIDTH - 1), number >> ROW), 0);
        vec2 place = uintBitsToFloat(stored.xy);
        float away = uintBitsToFloat(stored.z);
        vec4 light = vec4(unpacked_light(stored.w), 1.0);
        float reach = max(scaled / away, least);
        float behind = away + thickness * reach * away / magnification;
        float fall = 1.0 / (reach * reach), core = CORE * CORE * reach * reach;
        bool hidden = true;
        for (int i = 0; i < S; ++i) {
            vec2 aside = first + vec2(place_of(i)) - place;
            float squared = dot(aside, aside);
            float rise = max(1.0 - squared * fall, 0.0);
            bool here = away < surface[i];
            float weight = here ? rise * rise : 0.0;
            sums[i] += light * weight;
            away_sums[i] += away * weight;
            surface[i] = squared <= core ? min(surface[i], behind) : surface[i];
            hidden = hidden && !here;
        }
        if (hidden) {
            break;
        }
    }
    leave(sums, away_sums);
}

// What a rasteriser leaves of a pixel: the distance of each sample from the eye, negative where
// there is nothing, and each one's light. The depth marks where the plant is, so that the passes
// that follow spend time there alone.
#include "samples.glsl"

layout(location = 0) out PACKED out_away;
layout(location = 1) out vec4 out_light0;  // linear light, cover
#if SUPERSAMPLE > 1
layout(location = 2) out vec4 out_light1;
layout(location = 3) out vec4 out_light2;
layout(location = 4) out vec4 out_light3;
#endif

vec4 mean_light(vec4 sum) {
    return vec4(sum.rgb / max(sum.a, 1e-6), smoothstep(RIM_OUTSIDE, RIM_INSIDE, sum.a));
}

// sums: light times weight, weight; away_sums: distance times weight.
void leave(vec4 sums[S], float away_sums[S]) {
    bool anywhere = false;
    for (int i = 0; i < S; ++i) {
        bool here = sums[i].a > RIM_OUTSIDE;
        away_sums[i] = here ? away_sums[i] / sums[i].a : -1.0;
        anywhere = anywhere || here;
    }
    out_away = packed_samples(away_sums);
    out_light0 = mean_light(sums[0]);
#if SUPERSAMPLE > 1
    out_light1 = mean_light(sums[1]);
    out_light2 = mean_light(sums[2]);
    out_light3 = mean_light(sums[3]);
#endif
    gl_FragDepth = anywhere ? 0.0 : 1.0;
}

// Colour, coverage, depth and normal of each sample, as the passes over the points write them. The
// depth buffer marks the plant, and the passes that follow run only there.
#include "depth.glsl"

layout(location = 0) out vec4 out_color;   // linear light, cover
layout(location = 1) out float out_depth;  // relative
layout(location = 2) out vec2 out_normal;  // to the eye, aside and up, or UNKNOWN

// Summed weights of splats at which the plant's silhouette begins, and at which it is closed.
const float RIM_OUTSIDE = 0.16, RIM_INSIDE = 0.30;

// color_sum: linear light times weight, weight; inside: 1 inside the surface's edge, 0 outside.
void write_gbuffer(vec4 color_sum, float depth, vec2 normal, float inside) {
    float cover = inside * smoothstep(RIM_OUTSIDE, RIM_INSIDE, color_sum.a);
    out_color = vec4(color_sum.rgb / max(color_sum.a, 1e-6), cover);
    out_depth = cover > 0.0 ? depth : NOTHING;
    out_normal = normal;
    gl_FragDepth = cover > 0.0 ? 1.0 : 0.0;
}

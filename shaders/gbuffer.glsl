// Outputs of the passes over points: colour, coverage, depth and normal of each sample. The depth
// buffer is 1 on the plant and 0 elsewhere, so that later passes can be restricted to the plant.
#include "depth.glsl"

layout(location = 0) out vec4 out_color;   // linear light, coverage
layout(location = 1) out float out_depth;  // relative
layout(location = 2) out vec2 out_normal;  // x and y in eye coordinates, or UNKNOWN
layout(location = 3) out vec4 out_light;   // cleared for shade.frag

// Sums of weights of splats between which coverage rises from 0 to 1 at the plant's silhouette.
const float RIM_OUTSIDE = 0.16, RIM_INSIDE = 0.30;

// color_sum: sums of weighted linear light and of weights; inside: 0 beyond the edge, 1 inside it.
void write_gbuffer(vec4 color_sum, float depth, vec2 normal, float inside) {
    float coverage = inside * smoothstep(RIM_OUTSIDE, RIM_INSIDE, color_sum.a);
    out_color = vec4(color_sum.rgb / max(color_sum.a, 1e-6), coverage);
    out_depth = coverage > 0.0 ? depth : NOTHING;
    out_normal = normal;
    out_light = vec4(0.0);
    gl_FragDepth = coverage > 0.0 ? 1.0 : 0.0;
}

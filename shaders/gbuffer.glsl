// What the passes over the points leave of each sample: colour, cover and depth. The depth buffer
// tells where the plant is, so that the passes that follow run there alone.
#include "depth.glsl"
#include "splat_profile.glsl"

layout(location = 0) out vec4 out_color;   // linear light, cover
layout(location = 1) out float out_depth;  // relative

// color_sum: linear light times weight, weight; depth_sum: relative depth times weight.
void write_gbuffer(vec4 color_sum, float depth_sum) {
    bool covered = color_sum.a > RIM_OUTSIDE;
    float weight = max(color_sum.a, 1e-6);
    out_color = vec4(color_sum.rgb / weight, smoothstep(RIM_OUTSIDE, RIM_INSIDE, color_sum.a));
    out_depth = covered ? depth_sum / weight : NOTHING;
    gl_FragDepth = covered ? 0.0 : 1.0;
}

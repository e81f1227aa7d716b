// Clears the G-buffer for splat_behind.frag, and writes depth 1 where the nearest surface has ended
// although its splats occlude, and depth 0 elsewhere, where the depth test then rejects fragments.
#include "depth.glsl"

uniform sampler2D front;  // relative depths of the nearest surface
uniform sampler2D light;  // light times coverage, coverage

layout(location = 0) out vec4 out_color;
layout(location = 1) out float out_depth;
layout(location = 2) out vec2 out_normal;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    bool is_occluded = texelFetch(front, texel, 0).r < NOTHING;
    out_color = vec4(0.0);
    out_depth = NOTHING;
    out_normal = vec2(UNKNOWN);
    gl_FragDepth = is_occluded && texelFetch(light, texel, 0).a < 1.0 ? 1.0 : 0.0;
}

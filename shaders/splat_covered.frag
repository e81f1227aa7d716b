// Clears the surface, and writes depth 1 where the nearest one ends inside the splats that occlude
// what lies behind it, and 0 elsewhere, so that the depth test rejects what would not be visible.
#include "depth.glsl"

uniform sampler2D front;  // relative depths of the nearest surface
uniform sampler2D light;  // times cover, cover

layout(location = 0) out vec4 out_color;
layout(location = 1) out float out_depth;
layout(location = 2) out vec2 out_normal;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    bool hidden = texelFetch(front, texel, 0).r < NOTHING;
    out_color = vec4(0.0);
    out_depth = NOTHING;
    out_normal = vec2(UNKNOWN);
    gl_FragDepth = hidden && texelFetch(light, texel, 0).a < 1.0 ? 1.0 : 0.0;
}

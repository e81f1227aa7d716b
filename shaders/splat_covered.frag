// Writes depth 1 where the nearest surface ends inside the splats that occlude what lies behind it,
// and 0 elsewhere, so that the depth test rejects splats that would not be visible.
#include "depth.glsl"

uniform sampler2D front;   // relative depths of the nearest surface
uniform sampler2D colors;  // linear light, cover

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    bool hidden = texelFetch(front, texel, 0).r < NOTHING;
    gl_FragDepth = hidden && texelFetch(colors, texel, 0).a < 1.0 ? 1.0 : 0.0;
}

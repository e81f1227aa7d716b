// The splats' sums into colour, cover and depth.
#include "gbuffer.glsl"

uniform sampler2D color_sums;
uniform sampler2D depth_sums;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    write_gbuffer(texelFetch(color_sums, texel, 0), texelFetch(depth_sums, texel, 0).r);
}

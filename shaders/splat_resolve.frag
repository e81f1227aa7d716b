// Converts the sums of splats to colour, coverage, depth and normal. The surface ends where the
// weighted mean of the surrounding centres is too far away (Adamson and Alexa 2004, "Approximating
// bounded, non-orientable surfaces from points"), which is smoother than the rims of splats.
#include "gbuffer.glsl"

uniform sampler2D front;
uniform sampler2D color_sums;
uniform sampler2D moment_sums;
uniform sampler2D normal_sums;
uniform float edge;  // largest distance of that mean, in radii

const float SOFTNESS = 0.04;  // half the width of the transition, in radii

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 color = texelFetch(color_sums, texel, 0);
    vec4 moment = texelFetch(moment_sums, texel, 0) / max(color.a, 1e-6);
    vec2 normal = texelFetch(normal_sums, texel, 0).rg / max(color.a, 1e-6);
    float nearest = texelFetch(front, texel, 0).r;
    float depth = (nearest == NOTHING ? 0.0 : nearest) + moment.x;
    float offset = length(moment.zw), softness = clamp(0.7 * fwidth(offset), SOFTNESS, 0.15);
    float inside = smoothstep(edge + softness, edge - softness, offset);
    write_gbuffer(color, depth, moment.y > 0.0 ? normal : vec2(UNKNOWN), inside);
}

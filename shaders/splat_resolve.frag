// Converts the sums of splats to colour, coverage, depth and normal. The surface ends where the
// weighted mean of the surrounding centres is too far away (Adamson and Alexa 2004, "Approximating
// bounded, non-orientable surfaces from points"), which is smoother than the rims of splats. Between
// its edge and these rims, what lies behind continues as it is visible beyond them.
#include "gbuffer.glsl"

uniform sampler2D front;
uniform sampler2D color_sums;
uniform sampler2D moment_sums;
uniform sampler2D normal_sums;
uniform float edge;  // largest distance of that mean, in radii

const float SOFTNESS = 0.04;  // half the width of the transition, in radii
const float REACH = 0.8;      // radii within which another surface is searched for
const int STEPS = 8;          // of that search

// A sample's position relative to the mean of the surrounding centres, in radii.
vec2 offset_at(ivec2 texel) {
    return texelFetch(moment_sums, texel, 0).zw / max(texelFetch(color_sums, texel, 0).a, 1e-6);
}

// The first sample in a direction that shows the ground, or a surface behind the one at `texel`
// and not the edge of that; `texel` if there is none within reach.
ivec2 beyond(ivec2 texel, vec2 direction) {
    float nearest = texelFetch(front, texel, 0).r, thickness = THICKNESS * radius / scene_radius;
    vec2 reach = REACH * radius * focal_px / clip_w(view_depth_of(nearest)) * direction;
    ivec2 last = textureSize(front, 0) - 1, found = texel;
    for (int i = 1; i <= STEPS && found == texel; ++i) {
        ivec2 at = clamp(texel + ivec2(round(reach * float(i) / float(STEPS))), ivec2(0), last);
        float depth = texelFetch(front, at, 0).r;
        bool is_behind = depth - nearest > thickness && length(offset_at(at)) < edge;
        found = is_behind || depth == NOTHING ? at : texel;
    }
    return found;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy), source = texel;
    vec4 color = texelFetch(color_sums, texel, 0);
    vec2 offset = offset_at(texel);
    float softness = clamp(0.7 * fwidth(length(offset)), SOFTNESS, 0.15);
    float inside = smoothstep(edge + softness, edge - softness, length(offset));
    bool is_occluding = texelFetch(front, texel, 0).r < NOTHING;
    if (is_occluding && inside < 1.0) {
        ivec2 other = beyond(texel, offset / length(offset));
        if (texelFetch(front, other, 0).r < NOTHING) {
            vec4 behind = texelFetch(color_sums, other, 0);
            color = mix(behind / max(behind.a, 1e-6), color / max(color.a, 1e-6), inside);
            source = inside < 0.5 ? other : texel;
            inside = 1.0;
        }
    }
    float weight = max(texelFetch(color_sums, source, 0).a, 1e-6);
    vec2 moment = texelFetch(moment_sums, source, 0).xy / weight;
    vec2 normal = texelFetch(normal_sums, source, 0).rg / weight;
    float depth = (is_occluding ? texelFetch(front, source, 0).r : 0.0) + moment.x;
    write_gbuffer(color, depth, moment.y > 0.0 ? normal : vec2(UNKNOWN), inside);
}

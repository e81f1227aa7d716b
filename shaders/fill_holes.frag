// Fills the holes between points of one sample: every point is treated as a splat that covers the
// samples around it, and each sample becomes the weighted mean of splats on the nearest surface.
// The result is that of splat_sum.frag with centres rounded to samples, at a cost that does not
// depend on the number of points. Splats reach the REACH samples nearest to their centre, and their
// cores the CORE_REACH nearest ones.
#include "nearest_point.glsl"
#include "gbuffer.glsl"
#include "color.glsl"

// Offsets of samples, nearest first.
const ivec2 NEAREST[21] = ivec2[](
    ivec2(0, 0), ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1), ivec2(1, 1), ivec2(-1, 1),
    ivec2(1, -1), ivec2(-1, -1), ivec2(2, 0), ivec2(-2, 0), ivec2(0, 2), ivec2(0, -2), ivec2(2, 1),
    ivec2(2, -1), ivec2(-2, 1), ivec2(-2, -1), ivec2(1, 2), ivec2(1, -2), ivec2(-1, 2), ivec2(-1, -2)
);

uniform usampler2D nearest;
#if COLOR_FROM_TRACK
uniform sampler2D palette;
#else
uniform usampler2D picked;
#endif

uint code_at(ivec2 texel) {
    return texelFetch(nearest, clamp(texel, ivec2(0), samples - 1), 0).r;
}

vec3 color_of(uint code, ivec2 texel) {
#if COLOR_FROM_TRACK
    return texelFetch(palette, ivec2(code % MAX_TRACKS, 0), 0).rgb;
#else
    return unpacked_rgb(texelFetch(picked, clamp(texel, ivec2(0), samples - 1), 0).r);
#endif
}

// In samples, plus half a sample for the unknown position of a point within its sample.
float radius_at(float view_depth) {
    return max(radius * focal_px / clip_w(view_depth), 0.5 * point_px_range.x) + 0.5;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float surface = 1e30;  // depth behind which points are occluded
    for (int i = 0; i < CORE_REACH; ++i) {
        uint code = code_at(texel + NEAREST[i]);
        float depth = depth_of(code), splat = radius_at(depth), core = CORE * splat;
        float behind = depth + THICKNESS * (splat - 0.5) * clip_w(depth) / focal_px;
        bool hides = code != EMPTY && dot(vec2(NEAREST[i]), vec2(NEAREST[i])) <= core * core;
        surface = hides ? min(surface, behind) : surface;
    }
    // All splats on the surface are about as large in the picture.
    float splat = radius_at(min(surface, depth_range.y)), inv_area = 1.0 / (splat * splat);
    vec4 color_sum = vec4(0.0);
    float depth_sum = 0.0;
    for (int i = 0; i < REACH; ++i) {
        uint code = code_at(texel + NEAREST[i]);
        float depth = depth_of(code), squared_px = dot(vec2(NEAREST[i]), vec2(NEAREST[i]));
        float falloff = max(1.0 - squared_px * inv_area, 0.0);
        float weight = code == EMPTY || depth > surface ? 0.0 : falloff * falloff;
        color_sum += vec4(color_of(code, texel + NEAREST[i]), 1.0) * weight;
        depth_sum += relative_depth(depth) * weight;
    }
    write_gbuffer(color_sum, depth_sum / max(color_sum.a, 1e-6), vec2(UNKNOWN), 1.0);
}

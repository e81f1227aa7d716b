// Fills the holes between points of one sample each: every point is treated as a splat that covers
// the samples around it, and each sample is the weighted mean of the splats on the nearest surface.
// The result is that of splats (splat_sum.frag) whose centres are rounded to samples, at a cost
// that does not depend on the number of points. REACH is the largest radius of a splat in samples.
#include "nearest_point.glsl"
#include "gbuffer.glsl"
#include "color.glsl"

uniform usampler2D nearest;
uniform usampler2D picked;
uniform sampler2D palette;
uniform bool by_track;        // the ten bits name the colour

uint number_at(ivec2 texel) {
    return texelFetch(nearest, clamp(texel, ivec2(0), samples - 1), 0).r;
}

vec3 color_of(uint number, ivec2 texel) {
    return by_track ? texelFetch(palette, ivec2(number & 1023u, 0), 0).rgb
                    : unpacked_rgb(texelFetch(picked, clamp(texel, ivec2(0), samples - 1), 0).r);
}

// In samples, plus half a sample because a point may lie anywhere in its own.
float radius_at(float view_depth) {
    return max(radius * focal_px / clip_w(view_depth), 0.5 * point_px_range.x) + 0.5;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float surface = 1e30;  // what lies deeper is hidden
    for (int y = -REACH; y <= REACH; ++y) {
        for (int x = -REACH; x <= REACH; ++x) {
            uint number = number_at(texel + ivec2(x, y));
            float depth = depth_of(number), splat = radius_at(depth), core = CORE * splat;
            float behind = depth + THICKNESS * (splat - 0.5) * clip_w(depth) / focal_px;
            bool hides = number != EMPTY && float(x * x + y * y) <= core * core;
            surface = hides ? min(surface, behind) : surface;
        }
    }
    vec4 color_sum = vec4(0.0);
    float depth_sum = 0.0;
    for (int y = -REACH; y <= REACH; ++y) {
        for (int x = -REACH; x <= REACH; ++x) {
            uint number = number_at(texel + ivec2(x, y));
            float depth = depth_of(number), splat = radius_at(depth);
            float rise = max(1.0 - float(x * x + y * y) / (splat * splat), 0.0);
            float weight = number == EMPTY || depth > surface ? 0.0 : rise * rise;
            color_sum += vec4(color_of(number, texel + ivec2(x, y)), 1.0) * weight;
            depth_sum += relative_depth(depth) * weight;
        }
    }
    write_gbuffer(color_sum, depth_sum / max(color_sum.a, 1e-6), vec2(UNKNOWN), 1.0);
}

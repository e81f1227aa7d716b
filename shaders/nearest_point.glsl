// Codes of points that are drawn as single samples.
//
// A code consists of 22 bits of depth and 10 bits of the track. The nearest point has the smallest
// code, which one atomic operation per point can find. fill_holes.frag fills the holes afterwards.
#include "depth.glsl"

uniform mat4 view;
uniform vec2 focal;        // clip coordinates per unit of length where clip_w is 1
uniform ivec2 samples;     // width and height of the picture
uniform vec2 depth_range;  // depths of the near and the far plane

const float DEPTH_STEPS = 4194302.0;
const uint EMPTY = 0xFFFFFFFFu;

// Whether a point is in the picture; if it is, its sample and its code.
bool place_point(vec3 position, uint track, out ivec2 texel, out uint code) {
    vec3 view_pos = (view * vec4(position, 1.0)).xyz;
    float view_depth = -view_pos.z;
    vec2 clip_pos = view_pos.xy * focal / max(clip_w(view_depth), 1e-6);
    vec2 at = (clip_pos * 0.5 + 0.5) * vec2(samples);
    texel = ivec2(floor(at));
    float share = (view_depth - depth_range.x) / (depth_range.y - depth_range.x);
    code = (uint(int(clamp(share, 0.0, 1.0) * DEPTH_STEPS + 0.5)) << 10) | (track & 1023u);
    return share >= 0.0 && share <= 1.0
        && all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(samples)));
}

float depth_of(uint code) {
    return mix(depth_range.x, depth_range.y, float(code >> 10) / DEPTH_STEPS);
}

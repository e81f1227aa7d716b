// Codes of points that are drawn as single samples.
//
// A code consists of 22 bits of depth and 10 bits of the track. The nearest point has the smallest
// code, which one atomic operation per point can find. fill_holes.frag fills the holes afterwards.
#include "depth.glsl"

uniform mat4 to_samples;   // position in samples times clip_w, share of depth_range, clip_w
uniform ivec2 samples;     // width and height of the picture
uniform vec2 depth_range;  // depths of the near and the far plane

const float DEPTH_STEPS = 4194302.0;
const uint EMPTY = 0xFFFFFFFFu;

// Whether a point is in the picture; if it is, its sample and its code.
bool place_point(vec3 position, uint track, out ivec2 texel, out uint code) {
    vec4 placed = to_samples * vec4(position, 1.0);
    vec2 at = placed.xy / max(placed.w, 1e-6);
    texel = ivec2(at);
    code = uint(int(placed.z * DEPTH_STEPS + 0.5)) * MAX_TRACKS + track % MAX_TRACKS;
    return placed.z >= 0.0 && placed.z <= 1.0
        && all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(samples)));
}

float depth_of(uint code) {
    return mix(depth_range.x, depth_range.y, float(code / MAX_TRACKS) / DEPTH_STEPS);
}

// One direction of a bilateral filter of depths, which removes the scanner's noise and keeps edges
// (Tomasi and Manduchi 1998). Its radius is proportional to that of splats at any zoom.
#include "depth.glsl"

uniform sampler2D depths;  // relative
uniform ivec2 direction;
out float out_depth;

const float RADIUS = 1.3, MAX_RADIUS_PX = 24.0;  // of the filter, in radii of splats and in samples
const float MAX_TAPS = 8.0;                      // number of samples on either side

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy), last = textureSize(depths, 0) - 1;
    float depth = texelFetch(depths, texel, 0).r, w = clip_w(view_depth_of(depth));
    float radius_px = RADIUS * clamp(radius * focal_px / w, 0.5 * point_px_range.x, MAX_RADIUS_PX);
    float inv_range = scene_radius * focal_px / (radius_px * w);  // as wide in depth as laterally
    int taps = depth < NOTHING ? int(clamp(round(radius_px), 1.0, MAX_TAPS)) : 0;
    float sum = depth, total = 1.0;
    for (int tap = 1; tap <= taps; ++tap) {
        float lateral = 2.0 * float(tap) / float(taps);
        ivec2 shift = direction * int(round(float(tap) * radius_px / float(taps)));
        for (int side = -1; side <= 1; side += 2) {
            float neighbor = texelFetch(depths, clamp(texel + side * shift, ivec2(0), last), 0).r;
            float axial = (neighbor - depth) * inv_range;
            float gaussian = exp(-0.5 * (lateral * lateral + axial * axial));
            float weight = neighbor < NOTHING ? gaussian : 0.0;
            sum += weight * neighbor;
            total += weight;
        }
    }
    out_depth = sum / total;
}

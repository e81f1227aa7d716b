// One direction of a bilateral filter of the depths, which removes scanner noise and keeps edges
// (Tomasi and Manduchi 1998). Its radius is a splat's, so that it looks the same at any zoom.
#include "depth.glsl"

uniform sampler2D depths;  // relative
uniform ivec2 direction;
out float out_depth;

const float SMOOTHING = 1.3, MAX_RADIUS_PX = 24.0;  // in splat radii, and samples
const float MAX_TAPS = 8.0;                     // samples on either side

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy), last = textureSize(depths, 0) - 1;
    float depth = texelFetch(depths, texel, 0).r, w = clip_w(view_depth_of(depth));
    float reach = SMOOTHING * clamp(radius * focal_px / w, 0.5 * point_px_range.x, MAX_RADIUS_PX);
    float inv_range = scene_radius * focal_px / (reach * w);  // same scale in depth as across
    int taps = depth < NOTHING ? int(clamp(round(reach), 1.0, MAX_TAPS)) : 0;
    float sum = depth, total = 1.0;
    for (int tap = 1; tap <= taps; ++tap) {
        float aside = 2.0 * float(tap) / float(taps);
        ivec2 shift = direction * int(round(float(tap) * reach / float(taps)));
        for (int side = -1; side <= 1; side += 2) {
            float other = texelFetch(depths, clamp(texel + side * shift, ivec2(0), last), 0).r;
            float apart = (other - depth) * inv_range;
            float weight = other < NOTHING ? exp(-0.5 * (aside * aside + apart * apart)) : 0.0;
            sum += weight * other;
            total += weight;
        }
    }
    out_depth = sum / total;
}

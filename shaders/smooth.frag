// One direction of a bilateral blur of the distances: scanner noise goes, edges stay
// (Tomasi and Manduchi 1998). It reaches as far as a disc does, so it looks the same at any zoom.
// With CROSS, both directions at once, for discs that reach no farther than the next sample.
// With WHOLE, places are rounded to whole pixels, all of whose samples one look brings.
#version 330 core
#include "samples.glsl"

uniform sampler2D distances;
uniform ivec2 direction;
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;  // samples that one unit takes up at distance 1
uniform float smallest;       // diameter in samples
out PACKED out_away;

// TAPS: places looked at on either side.

float[S] pixel_at(ivec2 texel) {
    ivec2 last = textureSize(distances, 0) - 1;
    return unpacked(texelFetch(distances, clamp(texel, ivec2(0), last), 0));
}

// The samples that lie `shift` samples from those of a pixel, along one axis.
float[S] samples_at(ivec2 texel, ivec2 axis, int shift) {
#if SUPERSAMPLE == 1
    return pixel_at(texel + shift * axis);
#else
    int pixels = shift >> 1;  // rounded down
    float low[S] = pixel_at(texel + pixels * axis);
#if WHOLE
    return low;
#else
    float high[S] = pixel_at(texel + (pixels + 1) * axis);
    bool odd = (shift & 1) == 1;
    float across[S] = float[](low[1], high[0], low[3], high[2]);
    float up[S] = float[](low[2], low[3], high[0], high[1]);
    float found[S];
    for (int i = 0; i < S; ++i) {
        found[i] = !odd ? low[i] : axis.x > 0 ? across[i] : up[i];
    }
    return found;
#endif
#endif
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float here[S] = pixel_at(texel), sum[S], total[S], across[S];
    float farthest = 0.0;
    for (int i = 0; i < S; ++i) {
        farthest = max(farthest, here[i]);
        sum[i] = here[i];
        total[i] = 1.0;
    }
    float reach = clamp(radius * magnification / farthest, 0.5 * smallest, 24.0) * SMOOTHING;
    float narrow = magnification / reach;  // one by the depth across which surfaces are told apart
    for (int i = 0; i < S; ++i) {
        across[i] = narrow / max(here[i], 1e-6);
    }
#if CROSS
    for (int way = 0; way < 4; ++way) {
        float away[S] = samples_at(texel, ivec2(way < 2, way > 1), 1 - 2 * (way & 1));
        for (int i = 0; i < S; ++i) {
            float apart = (away[i] - here[i]) * across[i];
            float weight = away[i] > 0.0 ? 0.13 * exp(-0.5 * apart * apart) : 0.0;
            sum[i] += weight * away[i];
            total[i] += weight;
        }
    }
#else
    for (int tap = 1; tap <= TAPS; ++tap) {
        float aside = 2.0 * float(tap) / float(TAPS), far = float(tap) * reach / float(TAPS);
#if WHOLE
        int shift = SUPERSAMPLE * int(round(far / float(SUPERSAMPLE)));
#else
        int shift = int(round(far));
#endif
        for (int side = -1; side <= 1; side += 2) {
            float away[S] = samples_at(texel, direction, side * shift);
            for (int i = 0; i < S; ++i) {
                float apart = (away[i] - here[i]) * across[i];
                float weight = away[i] > 0.0 ? exp(-0.5 * (aside * aside + apart * apart)) : 0.0;
                sum[i] += weight * away[i];
                total[i] += weight;
            }
        }
    }
#endif
    for (int i = 0; i < S; ++i) {
        sum[i] = here[i] < 0.0 ? -1.0 : sum[i] / total[i];
    }
    out_away = packed_samples(sum);
}

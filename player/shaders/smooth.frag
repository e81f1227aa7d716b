// One direction of a bilateral blur of the distances: scanner noise goes, edges stay
// (Tomasi and Manduchi 1998). It reaches as far as a disc does, so it looks the same at any zoom.
// With CROSS, both directions at once, for discs that reach no farther than the next sample.
#version 330 core

uniform sampler2D distances;
uniform ivec2 direction;
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;  // samples that one unit takes up at distance 1
uniform float smallest;       // diameter in samples
out float out_away;

const int TAPS = 4;  // on either side

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy), last = textureSize(distances, 0) - 1;
    float here = texelFetch(distances, texel, 0).r;
    float reach = clamp(radius * magnification / here, 0.5 * smallest, 24.0) * SMOOTHING;
    float across = reach * here / magnification;
    float sum = here, total = 1.0;
#if CROSS
    for (int i = 0; i < 4; ++i) {
        ivec2 shift = ivec2(i < 2, i > 1) * (1 - 2 * (i & 1));
        float away = texelFetch(distances, clamp(texel + shift, ivec2(0), last), 0).r;
        float apart = (away - here) / across;
        float weight = away > 0.0 ? 0.13 * exp(-0.5 * apart * apart) : 0.0;
        sum += weight * away;
        total += weight;
    }
#else
    for (int i = 1; i <= TAPS; ++i) {
        float aside = 2.0 * float(i) / float(TAPS);
        ivec2 shift = direction * int(round(float(i) * reach / float(TAPS)));
        for (int side = -1; side <= 1; side += 2) {
            float away = texelFetch(distances, clamp(texel + side * shift, ivec2(0), last), 0).r;
            float apart = (away - here) / across;
            float weight = away > 0.0 ? exp(-0.5 * (aside * aside + apart * apart)) : 0.0;
            sum += weight * away;
            total += weight;
        }
    }
#endif
    out_away = sum / total;
}

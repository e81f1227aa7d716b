// One direction of a bilateral blur of the distances: scanner noise goes, edges stay
// (Tomasi and Manduchi 1998). The first direction divides the sums by their weights.

uniform sampler2D source;     // sums in the first direction, distances in the second
uniform sampler2D color_sum;
uniform bool first;
uniform ivec2 direction;
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;  // pixels that one unit takes up at distance 1
uniform float smallest;
uniform float scale;
uniform float middle;
out vec4 out_away;            // in scene radii beyond the target, FAR where nothing is

const float FAR = 1e4;
const int NARROW = 4, WIDE = 8;  // places on either side; fewer would leave stripes

float away_at(ivec2 texel) {
    float value = texelFetch(source, texel, 0).r;
    if (!first) {
        return value;
    }
    float weight = texelFetch(color_sum, texel, 0).a;
    return weight > 0.02 ? value / weight : FAR;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy), last = textureSize(source, 0) - 1;
    float here = away_at(texel);
    if (here >= FAR) {
        out_away = vec4(FAR);
        return;
    }
    float away = middle + scale * here;
    float reach = 1.3 * clamp(radius * magnification / away, 0.5 * smallest, 24.0);
    float across = reach * away / magnification / scale;
    float sum = here, total = 1.0;
    int taps = reach < 6.0 ? NARROW : WIDE;
    for (int i = 1; i <= taps; ++i) {
        float aside = 2.0 * float(i) / float(taps);
        ivec2 shift = direction * int(round(float(i) * reach / float(taps)));
        for (int side = -1; side <= 1; side += 2) {
            float met = away_at(clamp(texel + side * shift, ivec2(0), last));
            float apart = (met - here) / across;
            float weight = met < FAR ? exp(-0.5 * (aside * aside + apart * apart)) : 0.0;
            sum += weight * met;
            total += weight;
        }
    }
    out_away = vec4(sum / total);
}

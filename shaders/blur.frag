// One direction of a Gaussian blur of the shadow; the widths of its two channels differ.

in vec2 v_at;
uniform sampler2D transmittance;
uniform vec2 direction;  // one texel along the blur's direction
out vec2 out_transmittance;

const int TAPS = 13;                 // number of samples, at distances of two texels
const vec2 SIGMA = vec2(1.0, 4.5);   // standard deviations in texels: contact, ambient

void main() {
    vec2 sum = vec2(0.0), total = vec2(0.0);
    for (int i = 0; i < TAPS; ++i) {
        float offset = 2.0 * float(i - TAPS / 2) + 0.5;  // reads two texels at once
        vec2 weight = exp(-0.5 * offset * offset / (SIGMA * SIGMA));
        sum += weight * texture(transmittance, v_at + offset * direction).rg;
        total += weight;
    }
    out_transmittance = sum / total;
}

// One direction of a Gaussian blur of the shadow; each channel has its own width.

in vec2 v_at;
uniform sampler2D source;
uniform vec2 direction;  // one texel along the blur's direction
uniform bool saturate;   // convert summed coverage to the share of light that is blocked
out vec2 out_cover;

const int TAPS = 17;                 // two texels apart
const vec2 WIDTH = vec2(1.3, 6.0);   // standard deviations in texels: contact, ambient

void main() {
    vec2 sum = vec2(0.0), total = vec2(0.0);
    for (int i = 0; i < TAPS; ++i) {
        float aside = 2.0 * float(i - TAPS / 2) + 0.5;  // between two texels: one tap reads both
        vec2 weight = exp(-0.5 * aside * aside / (WIDTH * WIDTH));
        vec2 cover = texture(source, v_at + aside * direction).rg;
        sum += weight * (saturate ? 1.0 - exp(-cover) : cover);
        total += weight;
    }
    out_cover = sum / total;
}

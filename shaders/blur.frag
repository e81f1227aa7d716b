// One direction of a Gaussian blur of the shadow; each channel has its own width.

in vec2 v_at;
uniform sampler2D source;
uniform vec2 direction;  // one texel along the blur's direction
uniform bool saturate;   // turn summed cover into the share of light kept away
out vec2 out_cover;

const int LOOKS = 17;                // two texels apart
const vec2 WIDTH = vec2(1.3, 6.0);   // standard deviations in texels: contact, ambient

void main() {
    vec2 sum = vec2(0.0), total = vec2(0.0);
    for (int i = 0; i < LOOKS; ++i) {
        float aside = 2.0 * float(i - LOOKS / 2) + 0.5;  // between two texels: one look sees both
        vec2 weight = exp(-0.5 * aside * aside / (WIDTH * WIDTH));
        vec2 cover = texture(source, v_at + aside * direction).rg;
        sum += weight * (saturate ? 1.0 - exp(-cover) : cover);
        total += weight;
    }
    out_cover = sum / total;
}

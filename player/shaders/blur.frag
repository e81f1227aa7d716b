// One direction of a Gaussian blur of the shadow; each channel has its own width.
#version 330 core

in vec2 v_at;
uniform sampler2D source;
uniform vec2 direction;  // one texel along the blur's direction
uniform vec2 width;      // standard deviations in texels: contact, ambient
uniform bool saturate;   // turn summed cover into the share of light kept away
out vec2 out_cover;

void main() {
    vec2 sum = vec2(0.0), total = vec2(0.0);
    for (int i = -8; i <= 8; ++i) {
        float aside = 2.0 * float(i) + 0.5;  // between two texels: one look sees both
        vec2 weight = exp(-0.5 * aside * aside / (width * width));
        vec2 cover = texture(source, v_at + aside * direction).rg;
        sum += weight * (saturate ? 1.0 - exp(-cover) : cover);
        total += weight;
    }
    out_cover = sum / total;
}

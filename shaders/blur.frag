// One direction of a Gaussian blur of the shadow; each channel has its own width.
#version 330 core

in vec2 v_at;
uniform sampler2D source;
uniform vec2 direction;  // one texel along the blur's direction
uniform vec2 weights[LOOKS];
out vec2 out_cover;

void main() {
    vec2 sum = vec2(0.0);
    for (int i = 0; i < LOOKS; ++i) {
        float aside = 2.0 * float(i - LOOKS / 2) + 0.5;  // between two texels: one look sees both
        vec2 cover = texture(source, v_at + aside * direction).rg;
#if SATURATE
        cover = 1.0 - exp(-cover);  // summed cover into the share of light kept away
#endif
        sum += weights[i] * cover;
    }
    out_cover = sum;
}

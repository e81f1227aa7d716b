// One direction of a Gaussian blur of the shadow; each channel has its own width.

in vec2 v_at;
uniform sampler2D source;
uniform vec2 direction;  // one texel along the blur's direction
uniform bool saturate;   // turn summed cover into the share of light kept away
out vec4 out_cover;

const vec2 WIDTH = vec2(2.0, 9.0);  // standard deviations in texels: contact, ambient

void main() {
    vec2 sum = vec2(0.0), total = vec2(0.0);
    for (int i = -20; i <= 20; ++i) {
        vec2 weight = exp(-0.5 * float(i * i) / (WIDTH * WIDTH));
        vec2 cover = texture(source, v_at + float(i) * direction).rg;
        sum += weight * (saturate ? 1.0 - exp(-cover) : cover);
        total += weight;
    }
    out_cover = vec4(sum / total, 0.0, 0.0);
}

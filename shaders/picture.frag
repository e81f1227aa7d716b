// Composes the picture: the mean of SUPERSAMPLE x SUPERSAMPLE samples, over the background.
#include "color.glsl"
#include "ground.glsl"

in vec2 v_at;
uniform sampler2D light;    // light times coverage, coverage
uniform bool transparent;   // whether to leave out the background
out vec4 out_color;         // sRGB, unassociated alpha

// Interleaved gradient noise (Jimenez 2014), against visible bands in gradients of 8 bits.
float dither() {
    vec2 texel = floor(gl_FragCoord.xy);
    return (fract(52.9829189 * fract(dot(texel, vec2(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * SUPERSAMPLE;
    vec4 plant = vec4(0.0);
    for (int i = 0; i < SUPERSAMPLE * SUPERSAMPLE; ++i) {
        plant += texelFetch(light, corner + ivec2(i % SUPERSAMPLE, i / SUPERSAMPLE), 0);
    }
    plant /= float(SUPERSAMPLE * SUPERSAMPLE);
    vec3 linear = transparent ? plant.rgb / max(plant.a, 1e-4)
                              : plant.rgb + (1.0 - plant.a) * ground_color(v_at);
    out_color = vec4(linear_to_srgb(linear) + dither(), transparent ? plant.a : 1.0);
}

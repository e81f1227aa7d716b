// The finished picture: the plant over the ground, samples averaged in linear light.
#version 330 core
#include "srgb.glsl"

in vec2 v_at;
uniform sampler2D light;
uniform sampler2D ground;  // sRGB
uniform float opacity;
out vec4 out_color;

// Breaks up the banding of 8-bit gradients (interleaved gradient noise, Jimenez 2014).
float dither() {
    return fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
}

void main() {
    vec4 plant = vec4(0.0);
    ivec2 corner = ivec2(gl_FragCoord.xy) * SUPERSAMPLE;
    for (int y = 0; y < SUPERSAMPLE; ++y) {
        for (int x = 0; x < SUPERSAMPLE; ++x) {
            plant += texelFetch(light, corner + ivec2(x, y), 0);
        }
    }
    plant /= float(SUPERSAMPLE * SUPERSAMPLE);
    vec3 shown = textureLod(ground, v_at, 0.0).rgb;
    if (plant.a > 0.0) {
        shown = linear_to_srgb(plant.rgb + (1.0 - plant.a) * srgb_to_linear(shown));
    }
    out_color = vec4(shown + (dither() - 0.5) / 255.0, opacity);
}

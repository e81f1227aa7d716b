// Puts the plant over the background: the mean of the SUPERSAMPLE x SUPERSAMPLE samples of a pixel.
#include "color.glsl"
#include "dither.glsl"

uniform sampler2D light;       // light times coverage, coverage
uniform sampler2D background;  // sRGB
uniform bool transparent;      // whether to leave out the background
out vec4 out_color;            // sRGB, unassociated alpha

void main() {
    vec4 plant = vec4(0.0);
    for (int i = 0; i < SUPERSAMPLE * SUPERSAMPLE; ++i) {
        ivec2 offset = ivec2(i % SUPERSAMPLE, i / SUPERSAMPLE);
        plant += texelFetch(light, ivec2(gl_FragCoord.xy) * SUPERSAMPLE + offset, 0);
    }
    plant /= float(SUPERSAMPLE * SUPERSAMPLE);
    vec2 at = gl_FragCoord.xy * float(SUPERSAMPLE) / vec2(textureSize(light, 0));
    vec3 behind = texture(background, at).rgb;
    vec3 linear = transparent ? plant.rgb / max(plant.a, 1e-4)
                              : plant.rgb + (1.0 - plant.a) * srgb_to_linear(behind);
    vec3 srgb = transparent || plant.a > 0.0 ? linear_to_srgb(linear) : behind;
    out_color = vec4(dithered(srgb), transparent ? plant.a : 1.0);
}

// Draws the background: a wall, and effects on it.
#include "color.glsl"
#include "depth.glsl"

in vec2 v_at;
uniform vec3 top_color;     // of the wall at the top and the bottom
uniform vec3 bottom_color;
out vec4 out_color;         // sRGB

#include "effects.glsl"

void main() {
    vec2 offset = v_at - vec2(0.5, 0.55);
    float glow = exp(-dot(offset, offset) * 2.2);
    vec3 wall = mix(bottom_color, top_color, smoothstep(0.0, 1.0, v_at.y)) * mix(0.78, 1.12, glow);
    out_color = vec4(linear_to_srgb(with_effects(wall)), 1.0);
}

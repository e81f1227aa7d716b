// The ground's small picture over the whole one.
#version 330 core
#include "dither.glsl"

in vec2 v_at;
uniform sampler2D ground;  // sRGB
out vec4 out_color;

void main() {
    out_color = vec4(textureLod(ground, v_at, 0.0).rgb + dither(), 1.0);
}

// A finished picture, over another one.
#version 330 core

uniform sampler2D picture;
uniform float opacity;
out vec4 out_color;

void main() {
    out_color = vec4(texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb, opacity);
}

// Copies a picture to the viewport, scaled to its size.
#include "dither.glsl"

in vec2 v_at;
uniform sampler2D picture;
out vec4 out_color;

void main() {
    out_color = vec4(dithered(texture(picture, v_at).rgb), 1.0);
}

// Light on the plant, sample by sample.
#include "eye_dome.glsl"

uniform sampler2D colors;  // linear light, cover
out vec4 out_light;        // times cover, cover

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 color = texelFetch(colors, texel, 0);
    out_light = color.a > 0.0 ? vec4(lit(texel, color.rgb), 1.0) * color.a : vec4(0.0);
}

// Mean distances from the splats' sums; the depth marks where the plant is, so that the passes
// that follow spend time there alone.
#version 330 core

uniform sampler2D color_sum;
uniform sampler2D away_sum;
out float out_away;  // from the eye, negative where there is nothing

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float weight = texelFetch(color_sum, texel, 0).a;
    bool here = weight > RIM_OUTSIDE;
    out_away = here ? texelFetch(away_sum, texel, 0).r / weight : -1.0;
    gl_FragDepth = here ? 0.0 : 1.0;
}

// The splats' sums, sample by sample, as a rasteriser leaves them.
#version 330 core
#include "leave.glsl"

uniform sampler2D color_sum;
uniform sampler2D away_sum;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * SUPERSAMPLE;
    vec4 sums[S];
    float away_sums[S];
    for (int i = 0; i < S; ++i) {
        sums[i] = texelFetch(color_sum, corner + place_of(i), 0);
        away_sums[i] = texelFetch(away_sum, corner + place_of(i), 0).r;
    }
    leave(sums, away_sums);
}

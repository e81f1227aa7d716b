// Which pixels need every sample lit by itself: those where the plant ends, or one surface ends
// before another, or is seen edge-on. The depth tells: INSIDE where one light is enough, or EDGE.
#version 330 core
#include "samples.glsl"

uniform sampler2D distances;
uniform float steep;  // depth from which on samples are not one surface, at distance 1

void main() {
    float away[S] = unpacked(texelFetch(distances, ivec2(gl_FragCoord.xy), 0));
    float nearest = 1e30, farthest = -1.0;
    for (int i = 0; i < S; ++i) {
        nearest = min(nearest, away[i]);
        farthest = max(farthest, away[i]);
    }
    bool one = nearest >= 0.0 && farthest - nearest < steep * nearest;
    gl_FragDepth = one ? INSIDE : EDGE;
}

// Which pixels need every sample lit by itself: those where the plant ends, or one surface ends
// before another, or is seen edge-on. The depth tells: INSIDE where one light is enough, EDGE, or 1 without plant.
#version 330 core

uniform sampler2D distances;
uniform float steep;  // depth from which on samples are not one surface, at distance 1

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * SUPERSAMPLE;
    float nearest = 1e30, farthest = -1.0;
    for (int i = 0; i < SUPERSAMPLE * SUPERSAMPLE; ++i) {
        ivec2 texel = corner + ivec2(i % SUPERSAMPLE, i / SUPERSAMPLE);
        float away = texelFetch(distances, texel, 0).r;
        nearest = min(nearest, away);
        farthest = max(farthest, away);
    }
    bool one = nearest >= 0.0 && farthest - nearest < steep * nearest;
    gl_FragDepth = farthest < 0.0 ? 1.0 : one ? INSIDE : EDGE;
}

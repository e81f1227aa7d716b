// Splats as their points' tracks: whose organ is where.
#include "splat.glsl"

flat out uint v_track;

void main() {
    place_splat();
    v_track = in_track;
}

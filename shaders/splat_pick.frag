// Splats as their points' tracks: whose organ is where.
#include "splat_disc.glsl"

flat in uint v_track;
layout(location = 0) out uint out_track;

void main() {
    gl_FragDepth = window_depth(depth_in_core());
    out_track = v_track;
}

// Draws splats as track numbers, for picking organs.
#include "splat_disc.glsl"

flat in uint v_track;
layout(location = 0) out uint out_track;

void main() {
    depth_in_core();  // discards fragments outside the core
    out_track = v_track;
}

// First pass over the splats: the depths of the nearest surface. Only a splat's core hides what lies
// behind it, because surfaces blend into each other at its rim. The depth test compares the centres'
// depths, for a shader that writes depths is run for hidden samples, too.
#include "splat_disc.glsl"

layout(location = 0) out float out_front;  // relative

void main() {
    out_front = relative_depth(depth_in_core());
}

// First pass over the splats: the depth of the nearest surface. Only a splat's core occludes what
// lies behind it, because surfaces blend into each other at the rim. The depth test compares the
// depths of centres, because a shader that writes depths would also run for occluded samples.
#include "splat_disc.glsl"

layout(location = 0) out float out_front;  // relative

void main() {
    out_front = relative_depth(depth_in_core());
}

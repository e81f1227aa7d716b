// First pass over the splats: finds the depth of the nearest surface. Only the cores of splats
// occlude, because rims are blended. The depth test compares depths of centres, because a shader
// that writes depths would also run for occluded fragments.
#include "splat_disc.glsl"

layout(location = 0) out float out_front;  // relative

void main() {
    out_front = relative_depth(depth_in_core());
}

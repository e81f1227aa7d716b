// First pass over the splats: the depths of the nearest surface. Only a splat's core hides what lies
// behind: through its rim surfaces blend into each other.
#include "splat_disc.glsl"

layout(location = 0) out float out_front;  // relative

void main() {
    float depth = depth_in_core();
    out_front = relative_depth(depth);
    gl_FragDepth = window_depth(depth);
}

// Only a splat's core hides what lies behind: through its rim surfaces blend into each other.
#include "splat_profile.glsl"

void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    if (dot(at, at) > CORE * CORE) {
        discard;
    }
}

#include "splat_profile.glsl"

flat in uint v_track;
layout(location = 0) out uint out_track;

void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    if (dot(at, at) > CORE * CORE) {
        discard;
    }
    out_track = v_track;
}

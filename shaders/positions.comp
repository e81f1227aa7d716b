// Positions only, into a buffer.
#version 430 core
#include "stored_mover.glsl"

layout(local_size_x = WORKGROUP) in;
layout(std430, binding = 7) writeonly buffer Found { float found[]; };
uniform int count;

void put(uint mover, vec3 position) {
    if (mover < uint(count)) {
        found[3u * mover] = position.x;
        found[3u * mover + 1u] = position.y;
        found[3u * mover + 2u] = position.z;
    }
}

void main() {
    uint four = gl_GlobalInvocationID.x;
    Curves curves = stored_curves(four);
    for (uint i = 0u; i < 4u; ++i) {
        put(4u * four + i, on_curve(points_of(curves, i)));
    }
}

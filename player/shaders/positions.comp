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
    uint pair = gl_GlobalInvocationID.x;
    vec3 first, second;
    mover_positions(pair, first, second);
    put(2u * pair, first);
    put(2u * pair + 1u, second);
}

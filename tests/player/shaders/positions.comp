// Positions only, into a buffer.
#include "point_storage.glsl"

layout(local_size_x = WORKGROUP) in;
layout(std430, binding = 7) writeonly buffer Found { float found[]; };
uniform int count;

void main() {
    int group = int(gl_GlobalInvocationID.x);
    Movers movers = stored_movers(uint(group));
    for (int i = 0; i < 8; ++i) {
        int point = 8 * group + i;
        if (point < count) {
            vec3 position = bezier(curve_of(movers, i));
            for (int axis = 0; axis < 3; ++axis) {
                found[3 * point + axis] = position[axis];
            }
        }
    }
}

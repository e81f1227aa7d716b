// Where a mover is and how large its disc appears.

#include "../interpolate.glsl"

layout(location = 0) in vec3 in_point0;
#if DEGREE > 0
layout(location = 1) in vec3 in_point1;
#endif
#if DEGREE > 1
layout(location = 2) in vec3 in_point2;
#endif
#if DEGREE > 2
layout(location = 3) in vec3 in_point3;
#endif

uniform float alpha;  // share of the movers that are there: organs that fade dissolve

vec3 mover_position() {
#if DEGREE == 0
    return bezier(vec3[](in_point0));
#elif DEGREE == 1
    return bezier(vec3[](in_point0, in_point1));
#elif DEGREE == 2
    return bezier(vec3[](in_point0, in_point1, in_point2));
#else
    return bezier(vec3[](in_point0, in_point1, in_point2, in_point3));
#endif
}

// A fixed number in [0, 1) for each mover (a multiplicative hash, Knuth 1973).
float lot() {
    uint mixed = uint(gl_VertexID) * 2654435769u;
    mixed = (mixed ^ (mixed >> 15)) * 2246822519u;
    return float(mixed >> 8) / 16777216.0;
}

bool gone() {
    return lot() >= alpha;
}

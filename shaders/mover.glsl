// The mover's position from its vertex buffers.

#include "curve.glsl"

in vec3 in_point0;
#if DEGREE > 0
in vec3 in_point1;
#endif
#if DEGREE > 1
in vec3 in_point2;
#endif
#if DEGREE > 2
in vec3 in_point3;
#endif

#if DEGREE == 0
#define MOVER_POINTS vec3[](in_point0)
#elif DEGREE == 1
#define MOVER_POINTS vec3[](in_point0, in_point1)
#elif DEGREE == 2
#define MOVER_POINTS vec3[](in_point0, in_point1, in_point2)
#else
#define MOVER_POINTS vec3[](in_point0, in_point1, in_point2, in_point3)
#endif

vec3 mover_position() {
    return on_curve(MOVER_POINTS);
}

// Vertex attributes of a point, which depend on its interval: on the DEGREE of curves, and on
// whether there are SCAN_COLORS.

#include "interpolate.glsl"

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
layout(location = 4) in uint in_track;
#if SCAN_COLORS
layout(location = 5) in vec4 in_start_color;
layout(location = 6) in vec4 in_end_color;
#else
const vec4 in_start_color = vec4(0.0), in_end_color = vec4(0.0);
#endif

#if DEGREE == 0
#define IN_CURVE vec3[](in_point0)
#elif DEGREE == 1
#define IN_CURVE vec3[](in_point0, in_point1)
#elif DEGREE == 2
#define IN_CURVE vec3[](in_point0, in_point1, in_point2)
#else
#define IN_CURVE vec3[](in_point0, in_point1, in_point2, in_point3)
#endif

vec3 point_position() {
    return bezier(IN_CURVE);
}

// A point's value from 0 to 1, and its colour: SCALAR_FIELD 1 is height, 2 is speed
// (player/view/colors.py).

#if SCALAR_FIELD
uniform sampler2D ramp;            // linear light, from value 0 to 1
uniform vec4 height_axis;          // position to value: xyz the axis, w the offset
uniform float max_speed;           // the speed of value 1
uniform float slopes[DEGREE + 1];  // weights of the curve's points in the point's velocity

float scalar_value(vec3 curve[DEGREE + 1]) {
#if SCALAR_FIELD == 1
    return dot(height_axis.xyz, bezier(curve)) + height_axis.w;
#else
    vec3 velocity = vec3(0.0);
    for (int i = 0; i <= DEGREE; ++i) {
        velocity += slopes[i] * curve[i];
    }
    return length(box_step * velocity) / max_speed;
#endif
}

vec3 scalar_color(vec3 curve[DEGREE + 1]) {
    float last = float(textureSize(ramp, 0).x - 1);
    float value = clamp(scalar_value(curve), 0.0, 1.0);
    return texelFetch(ramp, ivec2(int(round(value * last)), 0), 0).rgb;
}
#endif

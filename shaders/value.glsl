// A mover's value from 0 to 1, and its colour: VALUED 1 is height, 2 is speed (player/colors.py).

#if VALUED
uniform sampler2D ramp;         // linear light, from value 0 to 1
uniform vec4 height_axis;       // position to value: xyz the axis, w the offset
uniform float fastest;          // the speed of value 1
uniform float slopes[DEGREE + 1];  // weights of the curve's points in the mover's velocity

float height_value(vec3 position) {
    return dot(height_axis.xyz, position) + height_axis.w;
}

float speed_value(vec3 points[DEGREE + 1]) {
    vec3 velocity = vec3(0.0);
    for (int i = 0; i <= DEGREE; ++i) {
        velocity += slopes[i] * points[i];
    }
    return length(box_step * velocity) / fastest;
}

vec3 value_light(float value) {
    float last = float(textureSize(ramp, 0).x - 1);
    return texelFetch(ramp, ivec2(int(round(clamp(value, 0.0, 1.0) * last)), 0), 0).rgb;
}
#endif

// Values of points from 0 to 1, and their colours. SCALAR_FIELD is the name of the function that
// computes the values (player/view/color_modes.py); it is undefined for other colours.

#ifdef SCALAR_FIELD
uniform sampler2D ramp;            // colour map in linear light
uniform vec4 height_axis;          // value = dot(xyz, position) + w
uniform float max_speed;           // speed of value 1
uniform float velocity_weights[DEGREE + 1];  // of the control points

float height_of(vec3 curve[DEGREE + 1]) {
    return dot(height_axis.xyz, bezier(curve)) + height_axis.w;
}

float speed_of(vec3 curve[DEGREE + 1]) {
    vec3 velocity = vec3(0.0);
    for (int i = 0; i <= DEGREE; ++i) {
        velocity += velocity_weights[i] * curve[i];
    }
    return length(box_step * velocity) / max_speed;
}

vec3 scalar_color(vec3 curve[DEGREE + 1]) {
    float last = float(textureSize(ramp, 0).x - 1);
    float value = clamp(SCALAR_FIELD(curve), 0.0, 1.0);
    return texelFetch(ramp, ivec2(int(round(value * last)), 0), 0).rgb;
}
#endif

// Positions of points, as `Clip.at` computes them (docs/format.md).
//
// Points move along Bezier curves of DEGREE 1, 2 or 3. Control points have the values stored in the
// clip: either integers that count steps from the interval's lower corner, or floats, for which the
// corner is 0 and the step is 1. `weights` are the Bernstein weights at the layer's parameter.

uniform vec3 box_low;
uniform vec3 box_step;
uniform float weights[DEGREE + 1];

vec3 bezier(vec3 curve[DEGREE + 1]) {
    vec3 blended = vec3(0.0);
    for (int i = 0; i <= DEGREE; ++i) {
        blended += weights[i] * curve[i];
    }
    return box_low + box_step * blended;
}

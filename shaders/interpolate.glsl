// Positions of points: the only interpolation, used by window, films, page and compute shaders
// (docs/format.md, `Clip.at`).
//
// A point moves along a Bezier curve of DEGREE 1, 2 or 3. Its control points are read as the clip
// stores them: integers that count steps from the interval's low corner, or floats with low 0 and
// step 1. `weights` are the Bernstein weights at the layer's parameter.

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

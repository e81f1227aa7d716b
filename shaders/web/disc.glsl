// A mover as a round, world-sized disc that faces the eye.

#include "place.glsl"

uniform mat4 view;
uniform mat4 projection;
uniform float radius;         // of the disc, in the clip's unit
uniform float magnification;  // pixels that one unit takes up at distance 1
uniform float smallest;       // diameter in pixels below which no disc shrinks

// Place the disc; gives its distance from the eye and its radius there.
vec2 place_disc() {
    vec4 seen = view * vec4(mover_position(), 1.0);
    float away = max(-seen.z, 1e-6);
    float size = max(2.0 * radius * magnification / away, smallest);
    gl_Position = gone() ? vec4(2.0, 2.0, 2.0, 1.0) : projection * seen;
    gl_PointSize = size;
    return vec2(away, 0.5 * size * away / magnification);
}

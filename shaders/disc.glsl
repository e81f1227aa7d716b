// A mover as a round, world-sized disc that faces the eye.

#include "mover.glsl"

uniform mat4 view;
uniform mat4 projection;
uniform float radius;     // of the disc, in the clip's unit
uniform float magnification;  // pixels that one unit takes up at distance 1
uniform float smallest;   // diameter in pixels below which no disc shrinks

// Place the disc; gives its distance from the eye and sets its radius there.
float place_disc(out float world_radius) {
    vec4 seen = view * vec4(mover_position(), 1.0);
    float away = max(-seen.z, 1e-6);
    gl_Position = projection * seen;
    gl_PointSize = max(2.0 * radius * magnification / away, smallest);
    world_radius = 0.5 * gl_PointSize * away / magnification;
    return away;
}

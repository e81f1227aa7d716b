// Positions only, for transform feedback: what a test compares with `Clip.at`.

#include "place.glsl"

out vec3 out_position;

void main() {
    out_position = mover_position();
}

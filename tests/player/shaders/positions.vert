// Positions only, for transform feedback.
#include "point_attributes.glsl"

out vec3 out_position;

void main() {
    out_position = point_position();
}

// Draws points of the plant from above, onto the light that reaches the floor.
#include "point_attributes.glsl"
#include "dissolve.glsl"
#include "organ_flags.glsl"

uniform mat4 from_above;  // from local coordinates to the shadow's square, height above it in z
uniform float contact_height;      // height over which contact shadows fade by 1/e
uniform float cover;      // share of a texel that one point covers

flat out vec2 v_blocked;

void main() {
    vec3 above = (from_above * vec4(point_position(), 1.0)).xyz;
    bool is_invisible = is_hidden(in_track) || presence(gl_VertexID) == 0.0;
    gl_Position = is_invisible ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(above.xy, 0.0, 1.0);
    gl_PointSize = 1.0;
    float contact = exp(-max(above.z, 0.0) / contact_height);
    v_blocked = 1.0 - exp(-cover * vec2(contact, 1.0));
}

// The plant seen from above, to find the light that it blocks from the floor.
#include "point_attributes.glsl"
#include "dissolve.glsl"
#include "organ_flags.glsl"

uniform mat4 from_above;  // local coordinates to the shadow's square, height above the floor in z
uniform float reach;      // height over which a contact shadow fades away
uniform float cover;      // share of a texel that one point covers

flat out vec2 v_cover;

void main() {
    vec3 above = (from_above * vec4(point_position(), 1.0)).xyz;
    bool unseen = is_hidden(in_track) || presence(gl_VertexID) == 0.0;
    gl_Position = unseen ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(above.xy, 0.0, 1.0);
    gl_PointSize = 1.0;
    v_cover = cover * vec2(exp(-max(above.z, 0.0) / reach), 1.0);
}

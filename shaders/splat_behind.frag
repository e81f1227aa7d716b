// Third pass over the splats: draws the surface behind the nearest one, where that one ends.
#include "splat_disc.glsl"

uniform sampler2D front;  // relative depths of the nearest surface

flat in vec3 v_color;
flat in vec2 v_normal;

layout(location = 0) out vec4 out_color;
layout(location = 1) out vec4 out_depth;
layout(location = 2) out vec2 out_normal;

void main() {
    float depth = relative_depth(depth_in_core());
    float behind = depth - texelFetch(front, ivec2(gl_FragCoord.xy), 0).r;
    if (behind < THICKNESS * v_radius / scene_radius) {
        discard;
    }
    out_color = vec4(v_color, 1.0);
    out_depth = vec4(depth, 0.0, 0.0, 0.0);
    out_normal = v_normal;
}

// Second pass over the splats: sums those on the nearest surface with weights that decrease
// towards the rim (Botsch et al. 2005, "High-quality surface splatting on today's GPUs").
#include "splat_disc.glsl"

uniform sampler2D front;  // relative depths of the nearest surface
uniform float edge;       // see splat_resolve.frag

flat in vec3 v_color;
flat in vec2 v_normal;

// Products with the weight; depths relative to the nearest surface, which half floats can hold.
layout(location = 0) out vec4 out_color;   // linear light, 1
layout(location = 1) out vec4 out_moment;  // depth, 1 if the normal is known, position in disc
layout(location = 2) out vec2 out_normal;

void main() {
    vec2 at = position_in_disc();
    float falloff = 1.0 - dot(at, at), max_depth = THICKNESS * v_radius / scene_radius;
    float nearest = texelFetch(front, ivec2(gl_FragCoord.xy), 0).r;
    bool is_rim = nearest == NOTHING;  // no core covers the sample
    float behind = relative_depth(depth_in_disc()) - (is_rim ? 0.0 : nearest);
    // If rims on both sides of a gap between two surfaces were averaged, the gap would be closed.
    bool is_other = edge > 1.0 ? !is_rim && behind > max_depth : is_rim || abs(behind) > max_depth;
    if (falloff <= 0.0 || is_other) {
        discard;
    }
    float weight = falloff * falloff;
    out_color = vec4(v_color, 1.0) * weight;
    out_moment = vec4(behind, NORMALS, at) * weight;
    out_normal = v_normal * weight;
}

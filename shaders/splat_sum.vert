// Second pass over the splats: those on the nearest surface, summed with weights that fall off to
// the rim (Botsch et al. 2005, "High-quality surface splatting on today's GPUs").
#include "splat.glsl"
#include "point_color.glsl"

flat out vec3 v_color;
flat out float v_depth;  // relative

void main() {
    v_depth = relative_depth(place_splat().x);
    v_color = point_color(IN_CURVE, in_track, in_start_color, in_end_color);
}

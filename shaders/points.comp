// Finds the nearest point of every sample (after Schuetz et al. 2021, "Rendering point clouds with
// compute shaders and vertex order optimization"). With PICK, in a second run over the points, the
// nearest ones write their colours.
#include "point_storage.glsl"
#include "nearest_point.glsl"
#include "dissolve.glsl"
#include "point_color.glsl"

layout(local_size_x = WORKGROUP) in;
layout(r32ui, binding = 0) uniform uimage2D nearest;
#if PICK
layout(r32ui, binding = 1) uniform uimage2D picked;
#endif
uniform int count;
uniform int stride;  // of so many fours one is drawn

void draw(int point, vec3 curve[DEGREE + 1], uint track) {
    ivec2 texel;
    uint number;
    if (point >= count || is_hidden(track) || presence(point) == 0.0
            || !place_point(bezier(curve), track, texel, number)) {
        return;
    }
#if !PICK
    // Most points are occluded by an earlier one, and reading is cheaper than an atomic operation.
    if (imageLoad(nearest, texel).r > number) {
        imageAtomicMin(nearest, texel, number);
    }
#else
    if (imageLoad(nearest, texel).r == number) {
        vec3 color = point_color(curve, track, stored_start(point), stored_end(point));
        imageAtomicMax(picked, texel, packed_rgb(color));
    }
#endif
}

void main() {
    int four = int(gl_GlobalInvocationID.x) * stride;
    if (4 * four >= count) {
        return;
    }
    Curves curves = stored_curves(uint(four));
    uint tracks[4] = stored_tracks(uint(four));
    draw(4 * four, curve_of(curves, 0), tracks[0]);
    draw(4 * four + 1, curve_of(curves, 1), tracks[1]);
    draw(4 * four + 2, curve_of(curves, 2), tracks[2]);
    draw(4 * four + 3, curve_of(curves, 3), tracks[3]);
}

// Finds the nearest point in each sample (after Schuetz et al. 2021, "Rendering point clouds with
// compute shaders and vertex order optimization"). A second pass over the points, with PICK, writes
// the colours of the nearest points.
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
uniform int stride;  // every n-th group of eight points is drawn

void draw(int first, Movers movers, int i) {
    int point = first + i;
    uint track = track_of(movers, i);
    vec3 curve[DEGREE + 1] = curve_of(movers, i);
    ivec2 texel;
    uint code;
    if (point >= count || is_hidden(track) || presence(point) == 0.0
            || !place_point(bezier(curve), track, texel, code)) {
        return;
    }
#if !PICK
    // Most points are occluded by earlier ones, and reading is faster than an atomic operation.
    if (imageLoad(nearest, texel).r > code) {
        imageAtomicMin(nearest, texel, code);
    }
#else
    if (imageLoad(nearest, texel).r == code) {
        vec3 color = point_color(curve, track, stored_start(point), stored_end(point));
        imageAtomicMin(picked, texel, packed_rgb(color));
    }
#endif
}

void main() {
    int group = int(gl_GlobalInvocationID.x) * stride;
    if (8 * group >= count) {
        return;
    }
    Movers movers = stored_movers(uint(group));
    draw(8 * group, movers, 0);  // not in a loop, which not every driver unrolls
    draw(8 * group, movers, 1);
    draw(8 * group, movers, 2);
    draw(8 * group, movers, 3);
    draw(8 * group, movers, 4);
    draw(8 * group, movers, 5);
    draw(8 * group, movers, 6);
    draw(8 * group, movers, 7);
}

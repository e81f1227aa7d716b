// Movers as dots: the nearest in every sample stays. With PICK, a second run over the movers, each
// that stayed leaves its colour.
#version 430 core
#include "stored_mover.glsl"
#include "dot.glsl"
#include "packed_light.glsl"
#include "marks.glsl"

layout(local_size_x = WORKGROUP) in;
layout(r32ui, binding = 0) uniform uimage2D nearest;
#if PICK
#include "light.glsl"
layout(r32ui, binding = 1) uniform uimage2D picked;
#endif
uniform int count;
uniform int every;  // of so many fours one is drawn

void draw(uint mover, vec3 points[DEGREE + 1], uint track) {
    vec3 position = on_curve(points);
    ivec2 texel;
    uint number;
    if (mover >= uint(count) || is_hidden(track)
            || !place_dot(position, track, texel, number)) {
        return;
    }
#if !PICK
    // Most movers lie behind one that is there already: reading is cheaper than the atomic.
    if (imageLoad(nearest, texel).r > number) {
        imageAtomicMin(nearest, texel, number);
    }
#else
    if (imageLoad(nearest, texel).r == number) {
#if VALUED == 1
        vec3 light = set_back(value_light(height_value(position)), track);
#elif VALUED == 2
        vec3 light = set_back(value_light(speed_value(points)), track);
#elif SCAN_COLORS
        vec3 light = mover_light(track, unpackUnorm4x8(stored_start_color[mover]),
                                 unpackUnorm4x8(stored_end_color[mover]));
#else
        vec3 light = track_light(track);
#endif
        imageAtomicMax(picked, texel, packed_light(light));
    }
#endif
}

void main() {
    uint four = gl_GlobalInvocationID.x * uint(every);
    if (4u * four >= uint(count)) {
        return;
    }
    Curves curves = stored_curves(four);
    uint tracks[4] = stored_tracks(four);
    draw(4u * four, points_of(curves, 0u), tracks[0]);
    draw(4u * four + 1u, points_of(curves, 1u), tracks[1]);
    draw(4u * four + 2u, points_of(curves, 2u), tracks[2]);
    draw(4u * four + 3u, points_of(curves, 3u), tracks[3]);
}

// Depths before the eye, and how large splats are there. Between the passes depths are kept
// relative to the scene, in its radii beyond the camera's target, so that half floats hold them
// finely.

uniform float target_depth;  // of the camera's target before the eye, in the clip's unit
uniform float scene_radius;  // in the clip's unit
uniform float perspective;   // 1, or 0 for a parallel projection
uniform vec2 half_extent;    // half of what the picture shows where clip_w is 1, across and up
uniform float radius;        // of a splat, in the clip's unit
uniform float focal_px;      // samples that one unit takes up where clip_w is 1
uniform vec2 point_px_range; // smallest and largest diameter of a splat in samples

const float NOTHING = 1e4;  // the relative depth where no point is
const float UNKNOWN = 2.0;  // a normal that is to be found from depths

// Of a splat, in its radii: where it stops to hide what lies behind, where it stops to contribute to
// the surface (its weight there is 4 %), and the depth over which splats count as one surface.
const float CORE = 0.7, RIM = 0.9, THICKNESS = 1.6;

float relative_depth(float view_depth) {
    return (view_depth - target_depth) / scene_radius;
}

float view_depth_of(float relative) {
    return target_depth + scene_radius * relative;
}

// What the projection divides by at a depth: a thing's size in the picture shrinks with it.
float clip_w(float view_depth) {
    return mix(1.0, view_depth, perspective);
}

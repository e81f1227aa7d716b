// Depths, and the size of splats in the picture. Textures hold relative depths: the distance behind
// the camera's target in scene radii, which half floats represent precisely.

uniform float target_depth;  // depth of the camera's target, in the clip's unit
uniform float scene_radius;  // in the clip's unit
uniform float perspective;   // 1 for a perspective projection, 0 for a parallel one
uniform vec2 half_extent;    // half the width and height of the visible area where clip_w is 1
uniform float radius;        // of a splat, in the clip's unit
uniform float focal_px;      // samples per unit of length where clip_w is 1
uniform vec2 point_px_range; // smallest and largest diameter of a splat in samples

const float UNKNOWN = 2.0;  // component of a normal that has to be derived from depths

// In radii of a splat: up to RIM it contributes to the surface (the weight there is 4 %), and splats
// within THICKNESS in depth are one surface.
const float RIM = 0.9, THICKNESS = 2.0;

float relative_depth(float view_depth) {
    return (view_depth - target_depth) / scene_radius;
}

float view_depth_of(float relative) {
    return target_depth + scene_radius * relative;
}

// The divisor of the projection at a depth.
float clip_w(float view_depth) {
    return mix(1.0, view_depth, perspective);
}

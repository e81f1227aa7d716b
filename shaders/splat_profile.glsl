// How a splat's weight falls off from its middle to its rim, and what the sums of weights mean.

const float CORE = 0.7;          // share of its radius in which a splat hides what lies behind
const float RIM_OUTSIDE = 0.16;  // summed weights where the plant's silhouette begins
const float RIM_INSIDE = 0.30;   // and where it is closed
const float THICKNESS = 1.6;     // depth, in splat radii, over which splats count as one surface

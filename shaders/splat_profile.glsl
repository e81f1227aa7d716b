// How a splat's weight falls off from its middle to its rim, and what the sums of weights mean.

const float RIM_OUTSIDE = 0.16;  // summed weights where the plant's silhouette begins
const float RIM_INSIDE = 0.30;   // and where it is closed

// Clears the targets of points: OpenGL's own clearing does not support integers here.

layout(location = 0) out uint out_nearest;
layout(location = 1) out uint out_picked;

void main() {
    out_nearest = 0xFFFFFFFFu;
    out_picked = 0u;
    gl_FragDepth = 1.0;
}

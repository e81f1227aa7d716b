// Clears a framebuffer of point codes, since moderngl cannot clear integer textures.

layout(location = 0) out uint out_nearest;
layout(location = 1) out uint out_picked;

void main() {
    out_nearest = 0xFFFFFFFFu;
    out_picked = 0u;
    gl_FragDepth = 1.0;
}

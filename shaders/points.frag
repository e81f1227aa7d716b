// Writes code and colour of a point that is drawn as a single sample.
flat in uint v_code;
flat in uint v_color;

layout(location = 0) out uint out_nearest;
layout(location = 1) out uint out_picked;

void main() {
    out_nearest = v_code;
    out_picked = v_color;
}

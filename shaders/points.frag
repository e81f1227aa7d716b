flat in uint v_number;
flat in uint v_color;

layout(location = 0) out uint out_nearest;
layout(location = 1) out uint out_picked;

void main() {
    out_nearest = v_number;
    out_picked = v_color;
}

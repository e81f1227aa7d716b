// Writes the share of light that a point blocks; blending multiplies what all points let through.
flat in vec2 v_blocked;
out vec2 out_blocked;

void main() {
    out_blocked = v_blocked;
}

// The only pass while things move: the nearest disc's core, as it is.

flat in vec3 v_color;
flat in float v_away;

layout(location = 0) out vec4 out_color;  // as splat.frag has them, with weight 1
layout(location = 1) out vec4 out_away;

void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    if (dot(at, at) > 0.49) {
        discard;
    }
    out_color = vec4(v_color, 1.0);
    out_away = vec4(v_away);
}

flat in vec3 v_color;
flat in float v_depth;

layout(location = 0) out vec4 out_color;   // linear light times weight, weight
layout(location = 1) out float out_depth;  // depth times weight

void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    float rise = 1.0 - dot(at, at);
    if (rise <= 0.0) {
        discard;
    }
    float weight = rise * rise;
    out_color = vec4(v_color, 1.0) * weight;
    out_depth = v_depth * weight;
}

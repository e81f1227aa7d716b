#version 330 core

flat in vec3 v_color;
flat in float v_away;

layout(location = 0) out vec4 out_color;  // linear light times weight, weight
layout(location = 1) out float out_away;  // distance times weight

void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    float rise = 1.0 - dot(at, at);
    if (rise <= 0.0) {
        discard;
    }
    float weight = rise * rise;
    out_color = vec4(v_color, 1.0) * weight;
    out_away = v_away * weight;
}

// What is behind the plant: the wall, and the floor with the plant's shadow. It is smooth
// everywhere, so a small picture of it is enough.
#version 330 core
#include "srgb.glsl"

in vec2 v_at;
uniform sampler2D shadow;
uniform vec2 half_field;
uniform mat4 to_floor;      // the eye's coordinates to the shadow's square, height above the floor in z
uniform float floor_share;  // 0 without floor
uniform float shadow_share; // 0 without shadow
uniform vec3 above_color;   // background at the top, at the bottom, and the lit floor
uniform vec3 below_color;
uniform vec3 floor_color;
uniform vec3 shadow_color;
out vec4 out_color;  // sRGB

vec3 background() {
    vec2 aside = v_at - vec2(0.5, 0.55);
    float glow = exp(-dot(aside, aside) * 2.2);
    vec3 wall = mix(below_color, above_color, smoothstep(0.0, 1.0, v_at.y));
    return wall * mix(0.78, 1.12, glow);
}

vec3 with_floor(vec3 wall) {
    vec3 ray = vec3((2.0 * v_at - 1.0) * half_field, -1.0);
    vec3 eye = to_floor[3].xyz, along = mat3(to_floor) * ray;
    if (eye.z <= 0.0 || along.z >= 0.0) {
        return wall;
    }
    vec2 spot = (eye - along * (eye.z / along.z)).xy;
    float disc = exp(-1.3 * dot(spot, spot));
    vec2 kept = shadow_share * texture(shadow, 0.5 * spot + 0.5).rg;
    kept *= 1.0 - smoothstep(0.8, 1.0, max(abs(spot.x), abs(spot.y)));
    float grazing = smoothstep(0.0, 0.12, -normalize(along).z);
    vec3 lit = mix(wall, floor_color, disc * floor_share * grazing);
    float dark = clamp(0.80 * kept.x + 0.62 * kept.y, 0.0, 0.9);
    return mix(lit, shadow_color, dark * floor_share * grazing);
}

void main() {
    out_color = vec4(linear_to_srgb(with_floor(background())), 1.0);
}

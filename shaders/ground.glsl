// The background in linear light: a wall, and a floor with the plant's shadow.
#include "depth.glsl"

uniform sampler2D shadow;
uniform mat4 to_floor;      // the eye's coordinates to the shadow's square, height above it in z
uniform float floor_share;  // 0 without floor
uniform vec3 top_color;     // the wall's at the picture's top and bottom, and the lit floor's
uniform vec3 bottom_color;
uniform vec3 floor_color;
uniform vec3 shadow_color;

vec3 wall_color(vec2 at) {
    vec2 aside = at - vec2(0.5, 0.55);
    float glow = exp(-dot(aside, aside) * 2.2);
    return mix(bottom_color, top_color, smoothstep(0.0, 1.0, at.y)) * mix(0.78, 1.12, glow);
}

// at: from (0, 0) at the picture's bottom left to (1, 1).
vec3 ground_color(vec2 at) {
    vec3 wall = wall_color(at);
    vec2 aside = (2.0 * at - 1.0) * half_extent;
    vec3 eye = vec3(aside, 10.0 * scene_radius) * (1.0 - perspective);  // parallels come from afar
    vec3 start = (to_floor * vec4(eye, 1.0)).xyz;
    vec3 ray = mat3(to_floor) * vec3(aside * perspective, -1.0);
    if (floor_share == 0.0 || start.z <= 0.0 || ray.z >= 0.0) {
        return wall;
    }
    vec2 spot = (start - ray * (start.z / ray.z)).xy;
    vec2 kept = textureLod(shadow, 0.5 * spot + 0.5, 0.0).rg;
    kept *= 1.0 - smoothstep(0.8, 1.0, max(abs(spot.x), abs(spot.y)));
    float share = floor_share * smoothstep(0.0, 0.12, -normalize(ray).z);
    vec3 lit = mix(wall, floor_color, exp(-1.3 * dot(spot, spot)) * share);
    return mix(lit, shadow_color, clamp(0.80 * kept.x + 0.62 * kept.y, 0.0, 0.9) * share);
}

// The background in linear light: a wall, and a floor with the plant's shadow.
#include "depth.glsl"

uniform sampler2D shadow;
uniform mat4 to_floor;      // from eye coordinates to the shadow's square and the height above it
uniform float floor_share;  // opacity of the floor
uniform vec3 top_color;     // of the wall at the top and the bottom, of lit and shadowed floor
uniform vec3 bottom_color;
uniform vec3 floor_color;
uniform vec3 shadow_color;

vec3 wall_color(vec2 at) {
    vec2 offset = at - vec2(0.5, 0.55);
    float glow = exp(-dot(offset, offset) * 2.2);
    return mix(bottom_color, top_color, smoothstep(0.0, 1.0, at.y)) * mix(0.78, 1.12, glow);
}

// at: position in the picture, from (0, 0) at the bottom left to (1, 1).
vec3 ground_color(vec2 at) {
    vec3 wall = wall_color(at);
    vec2 lateral = (2.0 * at - 1.0) * half_extent;
    vec3 eye = vec3(lateral, 10.0 * scene_radius) * (1.0 - perspective);  // parallel: from afar
    vec3 start = (to_floor * vec4(eye, 1.0)).xyz;
    vec3 ray = mat3(to_floor) * vec3(lateral * perspective, -1.0);
    if (floor_share == 0.0 || start.z <= 0.0 || ray.z >= 0.0) {
        return wall;
    }
    vec2 spot = (start - ray * (start.z / ray.z)).xy;
    vec2 blocked = textureLod(shadow, 0.5 * spot + 0.5, 0.0).rg;
    blocked *= 1.0 - smoothstep(0.8, 1.0, max(abs(spot.x), abs(spot.y)));
    float share = floor_share * smoothstep(0.0, 0.12, -normalize(ray).z);
    vec3 lit = mix(wall, floor_color, exp(-1.3 * dot(spot, spot)) * share);
    return mix(lit, shadow_color, clamp(0.80 * blocked.x + 0.62 * blocked.y, 0.0, 0.9) * share);
}

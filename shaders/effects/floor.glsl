// A floor with the plant's shadow.

uniform sampler2D transmittance;  // share of light that the plant lets through (blur.frag)
uniform mat4 to_floor;      // from eye coordinates to the shadow's square and the height above it
uniform vec3 floor_color;   // where it is lit, and in the shadow
uniform vec3 shadow_color;

vec3 with_floor(vec3 wall, float strength) {
    vec2 lateral = (2.0 * v_at - 1.0) * half_extent;
    vec3 eye = vec3(lateral, 10.0 * scene_radius) * (1.0 - perspective);  // parallel: from afar
    vec3 start = (to_floor * vec4(eye, 1.0)).xyz;
    vec3 ray = mat3(to_floor) * vec3(lateral * perspective, -1.0);
    if (start.z <= 0.0 || ray.z >= 0.0) {
        return wall;
    }
    vec2 spot = (start - ray * (start.z / ray.z)).xy;
    vec2 blocked = 1.0 - textureLod(transmittance, 0.5 * spot + 0.5, 0.0).rg;
    blocked *= 1.0 - smoothstep(0.8, 1.0, max(abs(spot.x), abs(spot.y)));
    float share = strength * smoothstep(0.0, 0.12, -normalize(ray).z);
    vec3 lit = mix(wall, floor_color, exp(-1.3 * dot(spot, spot)) * share);
    return mix(lit, shadow_color, clamp(0.80 * blocked.x + 0.62 * blocked.y, 0.0, 0.9) * share);
}

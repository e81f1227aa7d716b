// The finished picture: light on the surface from its distances alone, over floor and background.

#include "../color.glsl"

in vec2 v_at;
uniform sampler2D color_sum;
uniform sampler2D distances;  // in scene radii beyond the target
uniform sampler2D shadow;
uniform vec2 half_field;      // tangents of half the field of view, across and up
uniform mat4 to_floor;        // the eye's coordinates to the shadow's square
uniform vec3 sky;             // direction of up, in the eye's coordinates
uniform float scale;          // radius of the scene
uniform float middle;         // distance of the camera's target
uniform float dome_radius;    // in pixels
uniform float eye_dome;
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;
uniform vec3 sky_light;       // all lights and colours are linear
uniform vec3 floor_light;
uniform vec3 lamp_light;
uniform vec3 haze;
uniform float depth_cue;
uniform vec3 above_color;
uniform vec3 below_color;
uniform vec3 floor_color;
uniform vec3 shadow_color;
uniform float floor_share;    // 0 without floor
out vec4 out_color;

const float FAR = 1e4;
const int DIRECTIONS = 8;

float away_at(ivec2 texel) {
    return texelFetch(distances, texel, 0).r;
}

vec3 place(vec2 at, float away) {
    return vec3((2.0 * at - 1.0) * half_field, -1.0) * (middle + scale * away);
}

// How much the surroundings stand in front of this place, 0 where it lies free. What stands far in
// front is another organ: it darkens less, or every leaf would wear a black rim.
float sunken(ivec2 texel, ivec2 last, float away) {
    float sum = 0.0;
    for (int ring = 0; ring < 3; ++ring) {
        float aside = dome_radius * pow(2.8, float(ring)), deep = 0.012 * pow(2.2, float(ring));
        for (int i = 0; i < DIRECTIONS; ++i) {
            float angle = (float(i) + 0.33 * float(ring)) * 6.2831853 / float(DIRECTIONS);
            ivec2 other = texel + ivec2(round(aside * vec2(cos(angle), sin(angle))));
            float met = away_at(clamp(other, ivec2(0), last));
            float front = max((away - met) / deep, 0.0);
            sum += front / (1.0 + front * front);
        }
    }
    return sum / float(3 * DIRECTIONS);
}

// The normal from the distances on either side; at an edge the side on the same surface counts.
vec3 normal_at(ivec2 texel, ivec2 last, vec3 here, float away) {
    int reach = int(clamp(0.5 * radius * magnification / (middle + scale * away), 1.0, 8.0));
    vec2 size = vec2(last + 1);
    vec3 slopes[2];
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 aside = axis == 0 ? ivec2(reach, 0) : ivec2(0, reach);
        ivec2 ahead = min(texel + aside, last), back = max(texel - aside, ivec2(0));
        float far = away_at(ahead), close = away_at(back);
        vec3 forward = place((vec2(ahead) + 0.5) / size, far) - here;
        vec3 backward = here - place((vec2(back) + 0.5) / size, close);
        bool has_far = far < FAR, has_close = close < FAR;
        if (has_far && has_close) {
            float a = abs(far - away), b = abs(close - away);
            slopes[axis] = a > 3.0 * b ? backward : b > 3.0 * a ? forward : forward + backward;
        } else {
            slopes[axis] = has_far ? forward : has_close ? backward
                         : (axis == 0 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0));
        }
    }
    return normalize(cross(slopes[0], slopes[1]));
}

vec3 lit_plant(ivec2 texel, vec3 albedo) {
    ivec2 last = textureSize(color_sum, 0) - 1;
    float away = away_at(texel);
    vec3 here = place(v_at, away);
    vec3 normal = normal_at(texel, last, here, away);
    vec3 towards = normalize(-here);
    vec3 key = normalize(sky + vec3(-0.75, 0.10, 0.65));
    float lit = dot(normal, key);
    float direct = max(lit, 0.0) + 0.40 * max(-lit, 0.0);  // leaves let light through
    float open = exp(-2.2 * eye_dome * sunken(texel, last, away));
    vec3 ambient = mix(floor_light, sky_light, 0.5 + 0.5 * dot(normal, sky));
    float gloss = 0.05 * pow(max(dot(normal, normalize(key + towards)), 0.0), 20.0);
    float edge = 0.10 * pow(1.0 - max(dot(normal, towards), 0.0), 3.0);
    vec3 light = albedo * (ambient * open + lamp_light * direct * mix(open, 1.0, 0.3))
               + (gloss * lamp_light + edge * sky_light * albedo) * open;
    return mix(light, haze, depth_cue * smoothstep(-0.4, 1.6, away));
}

vec3 background() {
    vec2 aside = v_at - vec2(0.5, 0.55);
    vec3 wall = mix(below_color, above_color, smoothstep(0.0, 1.0, v_at.y));
    return wall * mix(0.78, 1.12, exp(-dot(aside, aside) * 2.2));
}

vec3 with_floor(vec3 wall) {
    vec3 ray = vec3((2.0 * v_at - 1.0) * half_field, -1.0);
    vec3 eye = to_floor[3].xyz, along = mat3(to_floor) * ray;
    if (eye.z <= 0.0 || along.z >= 0.0) {
        return wall;
    }
    vec2 spot = (eye - along * (eye.z / along.z)).xy;
    vec2 kept = texture(shadow, 0.5 * spot + 0.5).rg;
    kept *= 1.0 - smoothstep(0.8, 1.0, max(abs(spot.x), abs(spot.y)));
    float share = floor_share * smoothstep(0.0, 0.12, -normalize(along).z);
    vec3 lit = mix(wall, floor_color, exp(-1.3 * dot(spot, spot)) * share);
    return mix(lit, shadow_color, clamp(0.80 * kept.x + 0.62 * kept.y, 0.0, 0.9) * share);
}

// Breaks up the banding of 8-bit gradients (interleaved gradient noise, Jimenez 2014).
float dither() {
    return fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 sum = texelFetch(color_sum, texel, 0);
    float cover = smoothstep(0.16, 0.30, sum.a);
    vec3 picture = with_floor(background());
    if (cover > 0.0) {
        picture = mix(picture, lit_plant(texel, sum.rgb / sum.a), cover);
    }
    out_color = vec4(linear_to_srgb(picture) + (dither() - 0.5) / 255.0, 1.0);
}

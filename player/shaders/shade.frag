// Light on the surface that the splats left: normals and eye-dome shading from depth alone.
#version 330 core

in vec2 v_at;
uniform sampler2D color_sum;
uniform sampler2D distances;  // from the eye, negative where there is nothing
uniform vec2 half_field;      // tangents of half the field of view, across and up
uniform vec3 sky;             // direction of up, in the eye's coordinates
uniform float scale;          // radius of the scene
uniform float middle;         // distance of the camera's target
uniform float dome_radius;    // in samples
uniform float eye_dome;
uniform float depth_cue;
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;  // samples that one unit takes up at distance 1
uniform vec3 sky_light;       // ambient light from above, from below, and the lamp's
uniform vec3 floor_light;
uniform vec3 lamp_light;
uniform vec3 haze;            // what far parts recede into, linear light
out vec4 out_light;           // linear light, premultiplied by cover

const int DIRECTIONS = 8;

float away_at(ivec2 texel) {
    return texelFetch(distances, texel, 0).r;
}

vec3 place(vec2 at, float away) {
    return vec3((2.0 * at - 1.0) * half_field, -1.0) * away;
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
            float front = met < 0.0 ? 0.0 : max((away - met) / scale / deep, 0.0);
            sum += front / (1.0 + front * front);
        }
    }
    return sum / float(3 * DIRECTIONS);
}

// The normal from the distances on either side; at an edge the side on the same surface counts.
vec3 normal_at(ivec2 texel, ivec2 last, vec3 here, float away) {
    int reach = int(clamp(0.5 * radius * magnification / away, 1.0, 8.0));
    vec2 samples = vec2(last + 1);
    vec3 slopes[2];
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 aside = axis == 0 ? ivec2(reach, 0) : ivec2(0, reach);
        ivec2 ahead = min(texel + aside, last), back = max(texel - aside, ivec2(0));
        float far = away_at(ahead), close = away_at(back);
        vec3 forward = place((vec2(ahead) + 0.5) / samples, far) - here;
        vec3 backward = here - place((vec2(back) + 0.5) / samples, close);
        bool has_far = far > 0.0, has_close = close > 0.0;
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

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy), last = textureSize(color_sum, 0) - 1;
    vec4 sum = texelFetch(color_sum, texel, 0);
    float cover = smoothstep(RIM_OUTSIDE, RIM_INSIDE, sum.a);
    float away = away_at(texel);
    vec3 albedo = sum.rgb / sum.a;
    vec3 here = place(v_at, away);
    vec3 normal = normal_at(texel, last, here, away);
    vec3 towards = normalize(-here);
    vec3 key = normalize(sky + vec3(-0.75, 0.10, 0.65));

    // Leaves are thin: light from behind shines through.
    float lit = dot(normal, key);
    float direct = max(lit, 0.0) + 0.40 * max(-lit, 0.0);
    float open = exp(-2.2 * eye_dome * sunken(texel, last, away));
    vec3 ambient = mix(floor_light, sky_light, 0.5 + 0.5 * dot(normal, sky));
    float gloss = 0.05 * pow(max(dot(normal, normalize(key + towards)), 0.0), 20.0);
    float edge = 0.10 * pow(1.0 - max(dot(normal, towards), 0.0), 3.0);
    vec3 light = albedo * (ambient * open + lamp_light * direct * mix(open, 1.0, 0.3))
               + (gloss * lamp_light + edge * sky_light * albedo) * open;

    float far = smoothstep(-0.4, 1.6, (away - middle) / scale);
    light = mix(light, haze, depth_cue * far);
    out_light = vec4(light, 1.0) * cover;
}

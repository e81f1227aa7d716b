// Light on the surface that the splats left: normals and eye-dome shading from depth alone.
#version 330 core

in vec2 v_at;
uniform sampler2D color_sum;
uniform sampler2D away_sum;
uniform vec2 half_field;    // tangents of half the field of view, across and up
uniform vec3 sky;           // direction of up, in the eye's coordinates
uniform float scale;        // radius of the scene
uniform float middle;       // distance of the camera's target
uniform float dome_radius;  // in samples
uniform float eye_dome;
uniform float depth_cue;
uniform float lamp;         // overall brightness
uniform vec3 haze;          // what far parts recede into, linear light
out vec4 out_light;         // linear light, premultiplied by cover

const int DIRECTIONS = 8;

// Distance from the eye; negative where there is nothing.
float away_at(ivec2 texel) {
    float weight = texelFetch(color_sum, texel, 0).a;
    return weight > 0.0 ? texelFetch(away_sum, texel, 0).r / weight : -1.0;
}

vec3 place(vec2 at, float away) {
    return vec3((2.0 * at - 1.0) * half_field, -1.0) * away;
}

// How much the surroundings stand in front of this place, 0 where it lies free.
float sunken(ivec2 texel, ivec2 last, float away) {
    float sum = 0.0;
    for (int ring = 1; ring <= 2; ++ring) {
        for (int i = 0; i < DIRECTIONS; ++i) {
            float angle = (float(i) + 0.5 * float(ring)) * 6.2831853 / float(DIRECTIONS);
            vec2 aside = float(ring * ring) * dome_radius * vec2(cos(angle), sin(angle));
            float other = away_at(clamp(texel + ivec2(round(aside)), ivec2(0), last));
            float front = other < 0.0 ? 0.0 : (away - other) / scale;
            sum += min(max(front, 0.0), 0.05) / float(ring);
        }
    }
    return sum / float(DIRECTIONS);
}

// The normal from the depths on either side; at an edge the side on the same surface counts.
vec3 normal_at(ivec2 texel, ivec2 last, vec3 here, float away) {
    vec2 samples = vec2(last + 1);
    vec3 slopes[2];
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 aside = axis == 0 ? ivec2(NORMAL_STEP, 0) : ivec2(0, NORMAL_STEP);
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
    if (sum.a <= 0.0) {
        out_light = vec4(0.0);
        return;
    }
    float away = away_at(texel);
    vec3 albedo = sum.rgb / sum.a;
    vec3 here = place(v_at, away);
    vec3 normal = normal_at(texel, last, here, away);
    vec3 towards = normalize(-here);
    vec3 key = normalize(sky + vec3(-0.55, 0.15, 0.75));

    // Leaves are thin: light from behind shines through.
    float lit = dot(normal, key);
    float direct = max(lit, 0.0) + 0.35 * max(-lit, 0.0);
    float ambient = 0.5 + 0.5 * dot(normal, sky);
    float shine = pow(max(dot(normal, normalize(key + towards)), 0.0), 24.0);
    vec3 light = albedo * (mix(0.30, 0.62, ambient) + 0.85 * direct) + 0.035 * shine;

    light *= lamp * exp(-eye_dome * 22.0 * sunken(texel, last, away));
    float far = smoothstep(-1.0, 1.4, (away - middle) / scale);
    light = mix(light, haze, depth_cue * far);
    out_light = vec4(light, 1.0);
}

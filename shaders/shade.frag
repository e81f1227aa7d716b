// Light on the surface that the rasteriser left, over the ground: normals and eye-dome shading from
// distances alone. Of an edge's pixel every sample is lit by itself (BY_SAMPLE); elsewhere all of
// them are one surface, and lit as one.
#version 330 core
#include "srgb.glsl"
#include "dither.glsl"
#include "samples.glsl"

in vec2 v_at;
uniform sampler2D light0;       // of each sample: linear light, cover
#if SUPERSAMPLE > 1
uniform sampler2D light1;
uniform sampler2D light2;
uniform sampler2D light3;
#endif
uniform sampler2D distances;  // from the eye, negative where there is nothing
uniform sampler2D ground;     // sRGB
uniform vec2 half_field;      // tangents of half the field of view, across and up
uniform vec3 sky;             // direction of up, in the eye's coordinates
uniform vec3 key;             // direction of the lamp
uniform float scale;          // radius of the scene
uniform float middle;         // distance of the camera's target
uniform ivec2 dome[DIRECTIONS * RINGS];  // where the surroundings are looked at, in pixels
uniform float steepness[RINGS];          // one by the depth that counts most, for each ring
uniform float eye_dome;
uniform float depth_cue;
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;  // pixels that one unit takes up at distance 1
uniform vec3 sky_light;       // ambient light from above, from below, and the lamp's
uniform vec3 floor_light;
uniform vec3 lamp_light;
uniform vec3 haze;            // what far parts recede into, linear light
out vec4 out_color;

// How many samples are lit: all, or the first for all of them.
#if BY_SAMPLE
#define LIT S
#else
#define LIT 1
#endif

float[LIT] distances_at(ivec2 texel) {
    vec4 found = texelFetch(distances, texel, 0);
#if BY_SAMPLE
    return unpacked(found);
#else
    return float[](found.r);
#endif
}


// How much the surroundings stand in front of this place, 0 where it lies free. What stands far in
// front is another organ: it darkens less, or every leaf would wear a black rim.
float[LIT] sunken(ivec2 texel, ivec2 last, float away[LIT]) {
    float sum[LIT];
    for (int i = 0; i < LIT; ++i) {
        sum[i] = 0.0;
    }
    for (int ring = 0; ring < RINGS; ++ring) {
        for (int way = 0; way < DIRECTIONS; ++way) {
            ivec2 other = clamp(texel + dome[ring * DIRECTIONS + way], ivec2(0), last);
            float met[LIT] = distances_at(other);
            for (int i = 0; i < LIT; ++i) {
                float front = met[i] < 0.0 ? 0.0 : max((away[i] - met[i]) * steepness[ring], 0.0);
                sum[i] += front / (1.0 + front * front);
            }
        }
    }
    for (int i = 0; i < LIT; ++i) {
        sum[i] /= float(RINGS * DIRECTIONS);
    }
    return sum;
}

// The slope from one place to the next, `step` apart at distance 1, from the distances on either
// side; at an edge the side on the same surface counts, and at the picture's end the side that is
// there. `far` and `close` are negative where there is nothing.
vec3 slope(float far, float close, vec2 ahead, vec2 back, vec2 field, vec3 here) {
    float away = -here.z;
    vec3 forward = vec3(field + ahead, -1.0) * far - here;
    vec3 backward = here - vec3(field + back, -1.0) * close;
    float a = far > 0.0 && ahead != vec2(0.0) ? abs(far - away) : 1e30;
    float b = close > 0.0 && back != vec2(0.0) ? abs(close - away) : 1e30;
    vec3 found = a > 3.0 * b ? backward : b > 3.0 * a ? forward : forward + backward;
    return min(a, b) < 1e30 ? found : vec3(sign(ahead - back), 0.0);
}

vec3 lit(float away, vec3 normal, vec3 here, float depth, vec3 albedo) {
    vec3 towards = normalize(-here);

    // Leaves are thin: light from behind shines through.
    float facing = dot(normal, key);
    float direct = max(facing, 0.0) + 0.40 * max(-facing, 0.0);
    float open = exp(-2.2 * eye_dome * depth);
    vec3 ambient = mix(floor_light, sky_light, 0.5 + 0.5 * dot(normal, sky));
    float mirrored = max(dot(normal, normalize(key + towards)), 0.0);
    float fourth = mirrored * mirrored * mirrored * mirrored;
    float gloss = 0.05 * fourth * fourth * fourth * fourth * fourth;
    float grazing = 1.0 - max(dot(normal, towards), 0.0);
    float edge = 0.10 * grazing * grazing * grazing;
    vec3 light = albedo * (ambient * open + lamp_light * direct * mix(open, 1.0, 0.3))
               + (gloss * lamp_light + edge * sky_light * albedo) * open;

    float far = smoothstep(-0.4, 1.6, (away - middle) / scale);
    return mix(light, haze, depth_cue * far);
}

// The light of the pixel's samples.
vec3[LIT] lights(ivec2 texel, vec3 albedo[LIT]) {
    ivec2 last = textureSize(distances, 0) - 1;
    vec2 step = 2.0 * half_field / vec2(last + 1);
    float away[LIT] = distances_at(texel);
    float farthest = away[0];
    for (int i = 1; i < LIT; ++i) {
        farthest = max(farthest, away[i]);
    }
    int reach = int(clamp(0.5 * radius * magnification / farthest, 1.0, FARTHEST));
    ivec2 ahead = min(texel + reach, last), back = max(texel - reach, ivec2(0));
    float right[LIT] = distances_at(ivec2(ahead.x, texel.y));
    float left[LIT] = distances_at(ivec2(back.x, texel.y));
    float above[LIT] = distances_at(ivec2(texel.x, ahead.y));
    float below[LIT] = distances_at(ivec2(texel.x, back.y));
    vec2 forward = vec2(ahead - texel) * step, backward = vec2(back - texel) * step;
    float depth[LIT] = sunken(texel, last, away);
    vec3 found[LIT];
    for (int i = 0; i < LIT; ++i) {
        vec2 aside = (vec2(place_of(i)) + 0.5) / float(SUPERSAMPLE);
        vec2 field = (vec2(texel) + aside) * step - half_field;
        vec3 here = vec3(field, -1.0) * away[i];
        vec2 x = vec2(1.0, 0.0), y = vec2(0.0, 1.0);
        vec3 normal = normalize(cross(
            slope(right[i], left[i], x * forward, x * backward, field, here),
            slope(above[i], below[i], y * forward, y * backward, field, here)));
        found[i] = lit(away[i], normal, here, depth[i], albedo[i]);
    }
    return found;
}

// Of each sample: linear light, cover.
vec4[S] surface_at(ivec2 texel) {
#if SUPERSAMPLE == 1
    return vec4[](texelFetch(light0, texel, 0));
#else
    return vec4[](texelFetch(light0, texel, 0), texelFetch(light1, texel, 0),
                  texelFetch(light2, texel, 0), texelFetch(light3, texel, 0));
#endif
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 surface[S] = surface_at(texel);
    vec3 albedo[LIT];
    vec4 plant = vec4(0.0);  // premultiplied by cover
#if BY_SAMPLE
    float away[S] = distances_at(texel);
    for (int i = 0; i < S; ++i) {
        albedo[i] = surface[i].rgb;
    }
    vec3 light[S] = lights(texel, albedo);
    for (int i = 0; i < S; ++i) {
        float cover = away[i] < 0.0 ? 0.0 : surface[i].a;
        plant += cover > 0.0 ? vec4(light[i], 1.0) * (cover / float(S)) : vec4(0.0);
    }
#else
    vec4 mean = vec4(0.0);
    for (int i = 0; i < S; ++i) {
        mean += surface[i] / float(S);
    }
    albedo[0] = mean.rgb;
    plant = vec4(lights(texel, albedo)[0], 1.0) * mean.a;
#endif
    vec3 behind = srgb_to_linear(textureLod(ground, v_at, 0.0).rgb);
    out_color = vec4(linear_to_srgb(plant.rgb + (1.0 - plant.a) * behind) + dither(), 1.0);
}

// Light on the surface that the rasteriser left, over the ground: normals and eye-dome shading from
// distances alone. Of an edge's pixel every sample is lit by itself (BY_SAMPLE); elsewhere all of
// them are one surface, and lit as one.
#version 330 core
#include "srgb.glsl"
#include "dither.glsl"

in vec2 v_at;
uniform sampler2D color_sum;
uniform sampler2D distances;  // from the eye, negative where there is nothing
uniform sampler2D ground;     // sRGB
uniform vec2 half_field;      // tangents of half the field of view, across and up
uniform vec3 sky;             // direction of up, in the eye's coordinates
uniform vec3 key;             // direction of the lamp
uniform float scale;          // radius of the scene
uniform float middle;         // distance of the camera's target
uniform ivec2 dome[DIRECTIONS * RINGS];  // where the surroundings are looked at, in samples
uniform float steepness[RINGS];          // one by the depth that counts most, for each ring
uniform float eye_dome;
uniform float depth_cue;
uniform float radius;         // of a disc, in the clip's unit
uniform float magnification;  // samples that one unit takes up at distance 1
uniform vec3 sky_light;       // ambient light from above, from below, and the lamp's
uniform vec3 floor_light;
uniform vec3 lamp_light;
uniform vec3 haze;            // what far parts recede into, linear light
out vec4 out_color;

float away_at(ivec2 texel) {
    return texelFetch(distances, texel, 0).r;
}

// How much the surroundings stand in front of this place, 0 where it lies free. What stands far in
// front is another organ: it darkens less, or every leaf would wear a black rim.
float sunken(ivec2 texel, ivec2 last, float away) {
    float sum = 0.0;
    for (int ring = 0; ring < RINGS; ++ring) {
        for (int i = 0; i < DIRECTIONS; ++i) {
            ivec2 other = clamp(texel + dome[ring * DIRECTIONS + i], ivec2(0), last);
            float met = away_at(other);
            float front = met < 0.0 ? 0.0 : max((away - met) * steepness[ring], 0.0);
            sum += front / (1.0 + front * front);
        }
    }
    return sum / float(RINGS * DIRECTIONS);
}

// The slope towards x or y, from the distances on either side; at an edge the side on the same
// surface counts, and at the picture's end the side that is there.
vec3 slope(ivec2 texel, ivec2 last, ivec2 aside, vec3 here, vec2 field, vec2 texel_field) {
    ivec2 ahead = min(texel + aside, last), back = max(texel - aside, ivec2(0));
    float far = away_at(ahead), close = away_at(back), away = -here.z;
    vec3 forward = vec3(field + vec2(ahead - texel) * texel_field, -1.0) * far - here;
    vec3 backward = here - vec3(field + vec2(back - texel) * texel_field, -1.0) * close;
    float a = far > 0.0 && ahead != texel ? abs(far - away) : 1e30;
    float b = close > 0.0 && back != texel ? abs(close - away) : 1e30;
    vec3 found = a > 3.0 * b ? backward : b > 3.0 * a ? forward : forward + backward;
    return min(a, b) < 1e30 ? found : vec3(aside, 0.0);
}

vec3 lit(ivec2 texel, vec3 albedo) {
    ivec2 last = textureSize(distances, 0) - 1;
    vec2 texel_field = 2.0 * half_field / vec2(last + 1);
    vec2 field = (vec2(texel) + 0.5) * texel_field - half_field;
    float away = away_at(texel);
    vec3 here = vec3(field, -1.0) * away;
    int reach = int(clamp(0.5 * radius * magnification / away, 1.0, 8.0));
    vec3 normal = normalize(cross(slope(texel, last, ivec2(reach, 0), here, field, texel_field),
                                  slope(texel, last, ivec2(0, reach), here, field, texel_field)));
    vec3 towards = normalize(-here);

    // Leaves are thin: light from behind shines through.
    float facing = dot(normal, key);
    float direct = max(facing, 0.0) + 0.40 * max(-facing, 0.0);
    float open = exp(-2.2 * eye_dome * sunken(texel, last, away));
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

float cover_of(vec4 sum) {
    return smoothstep(RIM_OUTSIDE, RIM_INSIDE, sum.a);
}

// The light of one sample, premultiplied by cover.
vec4 covered(ivec2 texel) {
    vec4 sum = texelFetch(color_sum, texel, 0);
    float cover = away_at(texel) < 0.0 ? 0.0 : cover_of(sum);
    return cover > 0.0 ? vec4(lit(texel, sum.rgb / sum.a), 1.0) * cover : vec4(0.0);
}

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * SUPERSAMPLE;
    float share = 1.0 / float(SUPERSAMPLE * SUPERSAMPLE);
#if BY_SAMPLE
    vec4 plant = covered(corner);
#if SUPERSAMPLE > 1
    for (int i = 1; i < SUPERSAMPLE * SUPERSAMPLE; ++i) {
        plant += covered(corner + ivec2(i % SUPERSAMPLE, i / SUPERSAMPLE));
    }
#endif
    plant *= share;
#else
    vec4 albedo = vec4(0.0);
    for (int i = 0; i < SUPERSAMPLE * SUPERSAMPLE; ++i) {
        vec4 sum = texelFetch(color_sum, corner + ivec2(i % SUPERSAMPLE, i / SUPERSAMPLE), 0);
        albedo += share * vec4(sum.rgb / sum.a, cover_of(sum));
    }
    vec4 plant = vec4(lit(corner, albedo.rgb), 1.0) * albedo.a;
#endif
    vec3 behind = srgb_to_linear(textureLod(ground, v_at, 0.0).rgb);
    out_color = vec4(linear_to_srgb(plant.rgb + (1.0 - plant.a) * behind) + dither(), 1.0);
}

// Deferred shading of the plant: lighting, and effects on it. Where points have no normals, these
// are derived from depths.
#include "depth.glsl"

const vec3 KEY_LIGHT = vec3(-0.75, 0.10, 0.65);  // from `up_dir` to the direction of the lamp

uniform sampler2D colors;  // linear light, coverage
uniform sampler2D depths;  // relative
uniform sampler2D normals;  // see gbuffer.glsl
uniform vec3 up_dir;       // in eye coordinates
uniform vec3 ambient_top;  // light from above, from below, and of the lamp; linear
uniform vec3 ambient_bottom;
uniform vec3 key_light;
uniform vec3 fog_color;    // that distant parts fade into
out vec4 out_light;        // light times coverage, coverage

struct Surface {
    ivec2 texel;
    float depth;             // relative
    vec3 albedo, lamplight;  // its colour, and what it scatters of the lamp's light; linear
    vec3 normal, to_eye;     // in eye coordinates
} surface;                   // at this sample, for effects

float depth_at(ivec2 texel) {
    return texelFetch(depths, clamp(texel, ivec2(0), textureSize(depths, 0) - 1), 0).r;
}

vec3 view_pos(ivec2 texel, float depth) {
    vec2 at = (vec2(texel) + 0.5) / vec2(textureSize(depths, 0));
    float view_depth = view_depth_of(depth);
    return vec3((2.0 * at - 1.0) * half_extent * clip_w(view_depth), -view_depth);
}

// The tangent of the surface in the direction of `offset` (in samples) by central differences; at
// an edge by the neighbour on the same surface. Without neighbours the surface faces the camera.
vec3 tangent(ivec2 texel, ivec2 offset, float depth) {
    ivec2 last = textureSize(depths, 0) - 1;
    ivec2 ahead = min(texel + offset, last), back = max(texel - offset, ivec2(0));
    float next = depth_at(ahead), previous = depth_at(back);
    vec3 center = view_pos(texel, depth);
    vec3 forward = view_pos(ahead, next) - center, backward = center - view_pos(back, previous);
    float a = next < NOTHING && ahead != texel ? abs(next - depth) : NOTHING;
    float b = previous < NOTHING && back != texel ? abs(previous - depth) : NOTHING;
    vec3 difference = a > 3.0 * b ? backward : b > 3.0 * a ? forward : forward + backward;
    return min(a, b) < NOTHING ? difference : vec3(offset, 0.0);
}

vec3 normal_at(ivec2 texel, float depth) {
    float splat_px = radius * focal_px / clip_w(view_depth_of(depth));
    int offset = int(clamp(0.5 * splat_px, 1.0, 8.0));
    return normalize(cross(tangent(texel, ivec2(offset, 0), depth),
                           tangent(texel, ivec2(0, offset), depth)));
}

#include "effects.glsl"

// Light that the surface reflects to the camera.
vec3 lit(ivec2 texel, vec3 albedo) {
    float depth = depth_at(texel);
    vec2 lateral = texelFetch(normals, texel, 0).rg;
    vec3 known = vec3(lateral, sqrt(max(1.0 - dot(lateral, lateral), 0.0)));
    vec3 normal = lateral.x < UNKNOWN ? known : normal_at(texel, depth);
    vec3 to_eye = normalize(-view_pos(texel, depth));
    to_eye = perspective > 0.0 ? to_eye : vec3(0.0, 0.0, 1.0);

    // Leaves are thin and translucent: they are also lit from behind.
    vec3 to_lamp = normalize(up_dir + KEY_LIGHT);
    float facing = dot(normal, to_lamp);
    float direct = max(facing, 0.0) + 0.40 * max(-facing, 0.0);
    vec3 lamplight = albedo * key_light * direct;
    vec3 ambient = mix(ambient_bottom, ambient_top, 0.5 + 0.5 * dot(normal, up_dir));
    float mirrored = max(dot(normal, normalize(to_lamp + to_eye)), 0.0);
    float gloss = 0.05 * pow(mirrored, 20.0);
    float grazing = 1.0 - max(dot(normal, to_eye), 0.0);
    float edge = 0.10 * grazing * grazing * grazing;
    surface = Surface(texel, depth, albedo, lamplight, normal, to_eye);
    return with_effects(albedo * (ambient + edge * ambient_top) + lamplight + gloss * key_light);
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 color = texelFetch(colors, texel, 0);
    out_light = color.a > 0.0 ? vec4(lit(texel, color.rgb), 1.0) * color.a : vec4(0.0);
}

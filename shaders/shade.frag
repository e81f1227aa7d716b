// Deferred shading of the plant, with eye-dome lighting (Boucheny 2009). Where points have no
// normals, these are derived from depths.
#include "depth.glsl"

const int RINGS = 3, DIRECTIONS = 6;  // of the neighbours that are sampled for eye-dome lighting
const mat2 TURN = mat2(0.5, 0.8660, -0.8660, 0.5);  // to the next direction
const mat2 OUTWARDS = 2.8 * mat2(0.9397, 0.3420, -0.3420, 0.9397);  // to the next ring
const vec3 KEY_LIGHT = vec3(-0.75, 0.10, 0.65);  // from `up_dir` to the direction of the lamp

uniform sampler2D colors;  // linear light, coverage
uniform sampler2D depths;  // relative
uniform sampler2D normals;  // see gbuffer.glsl
uniform float eye_dome;    // strength of eye-dome lighting
uniform float depth_cue;   // share of fog in the colour of the farthest parts
uniform vec3 up_dir;       // in eye coordinates
uniform vec3 ambient_top;  // light from above, from below, and of the lamp; linear
uniform vec3 ambient_bottom;
uniform vec3 key_light;
uniform vec3 fog_color;    // that distant parts fade into
out vec4 out_light;        // light times coverage, coverage

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

// Occlusion of a sample by its neighbours in the picture, 0 if none is in front of it. Those far in
// front are other organs and occlude less; otherwise every leaf would have a black outline.
float occlusion(ivec2 texel, float depth) {
    float sum = 0.0, inv_depth = 1.0 / 0.012;  // inverse of the depth that occludes most
    float scale = max(1.2 * float(textureSize(depths, 0).y) / 720.0, 1.0);
    vec2 offset = vec2(1.0, 0.0);
    for (int ring = 0; ring < RINGS; ++ring) {
        for (int i = 0; i < DIRECTIONS; ++i) {
            float neighbor = depth_at(texel + ivec2(round(scale * offset)));
            float front = max((depth - neighbor) * inv_depth, 0.0);
            sum += front / (1.0 + front * front);
            offset = TURN * offset;
        }
        inv_depth /= 2.2;
        offset = OUTWARDS * offset;
    }
    return sum / float(RINGS * DIRECTIONS);
}

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
    float open = exp(-2.2 * eye_dome * occlusion(texel, depth));
    vec3 ambient = mix(ambient_bottom, ambient_top, 0.5 + 0.5 * dot(normal, up_dir));
    float mirrored = max(dot(normal, normalize(to_lamp + to_eye)), 0.0);
    float gloss = 0.05 * pow(mirrored, 20.0);
    float grazing = 1.0 - max(dot(normal, to_eye), 0.0);
    float edge = 0.10 * grazing * grazing * grazing;
    vec3 light = albedo * (ambient * open + key_light * direct * mix(open, 1.0, 0.3))
               + (gloss * key_light + edge * ambient_top * albedo) * open;
    return mix(light, fog_color, depth_cue * smoothstep(-0.4, 1.6, depth));
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 color = texelFetch(colors, texel, 0);
    out_light = color.a > 0.0 ? vec4(lit(texel, color.rgb), 1.0) * color.a : vec4(0.0);
}

// A mover as one sample of the picture: which one, how far away, which segment.
//
// 22 bits of depth above 10 of the segment in one number: the smallest is the nearest. It takes one
// atomic operation a mover, and the picture's own passes close the surface (gather.frag).

uniform mat4 view;
uniform vec2 focal;     // half the picture's size at distance 1, as OpenGL's projection has it
uniform ivec2 samples;  // the picture's size
uniform vec2 depths;    // from the eye, of the nearest and the farthest that is seen

const float DEPTH_STEPS = 4194302.0;
const uint EMPTY = 0xFFFFFFFFu;

// Whether the mover is in the picture, and if so, its sample and its number there.
bool place_dot(vec3 position, uint track, out ivec2 texel, out uint number) {
    vec3 seen = (view * vec4(position, 1.0)).xyz;
    float away = -seen.z;
    vec2 at = (seen.xy * focal / max(away, 1e-6) * 0.5 + 0.5) * vec2(samples);
    texel = ivec2(floor(at));
    float deep = (away - depths.x) / (depths.y - depths.x);
    number = (uint(int(clamp(deep, 0.0, 1.0) * DEPTH_STEPS + 0.5)) << 10) | (track & 1023u);
    return deep >= 0.0 && deep <= 1.0
        && all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(samples)));
}

float dot_distance(uint number) {
    return depths.x + (depths.y - depths.x) * (float(number >> 10) / DEPTH_STEPS);
}

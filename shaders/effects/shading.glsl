// Eye-dome lighting (Boucheny 2009): a sample is darker behind its neighbours in the picture. Those
// far in front are other organs and occlude less; otherwise every leaf would have a black outline.
vec3 with_shading(vec3 light, float strength) {
    const int RINGS = 3, DIRECTIONS = 6;  // of the neighbours that are sampled
    const mat2 TURN = mat2(0.5, 0.8660, -0.8660, 0.5);  // to the next direction
    const mat2 OUTWARDS = 2.8 * mat2(0.9397, 0.3420, -0.3420, 0.9397);  // to the next ring
    float sum = 0.0, inv_depth = 1.0 / 0.012;  // inverse of the depth that occludes most
    float scale = max(1.2 * float(textureSize(depths, 0).y) / 720.0, 1.0);
    vec2 offset = vec2(1.0, 0.0);
    for (int ring = 0; ring < RINGS; ++ring) {
        for (int i = 0; i < DIRECTIONS; ++i) {
            float neighbor = depth_at(surface.texel + ivec2(round(scale * offset)));
            float front = max((surface.depth - neighbor) * inv_depth, 0.0);
            sum += front / (1.0 + front * front);
            offset = TURN * offset;
        }
        inv_depth /= 2.2;
        offset = OUTWARDS * offset;
    }
    float open = exp(-2.2 * strength * sum / float(RINGS * DIRECTIONS));
    return mix(0.3 * surface.lamplight, light, open);  // the lamp also lights what is occluded
}

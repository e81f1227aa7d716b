// Distant parts fade into the background, the farthest ones by a share of 0.45.
vec3 with_depth_cue(vec3 light, float strength) {
    return mix(light, fog_color, 0.45 * strength * smoothstep(-0.4, 1.6, surface.depth));
}

// Colours of organs, and with HAS_FLAGS their visibility.

// Linear light; alpha is 0 for hidden organs, 1 for visible ones, and in between for dimmed ones.
uniform sampler2D palette;

vec4 organ_texel(uint track) {
    int width = textureSize(palette, 0).x, id = int(track);
    return texelFetch(palette, ivec2(id % width, id / width), 0);
}

bool is_hidden(uint track) {
#if HAS_FLAGS
    return organ_texel(track).a == 0.0;
#else
    return false;
#endif
}

vec3 dimmed(vec3 linear, uint track) {
#if HAS_FLAGS
    return mix(vec3(dot(linear, GREY)), linear, organ_texel(track).a);
#else
    return linear;
#endif
}

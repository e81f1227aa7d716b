// Which organs are hidden, and which stand back behind a highlighted one.
#ifndef MARKS
#define MARKS

#if MARKED
uniform sampler2D marks;  // by track; alpha: 0 hidden, 1 as usual, between: stands back

float mark_of(uint track) {
    int width = textureSize(marks, 0).x, id = int(track);
    return texelFetch(marks, ivec2(id % width, id / width), 0).a;
}
#endif

bool is_hidden(uint track) {
#if MARKED
    return mark_of(track) == 0.0;
#else
    return false;
#endif
}

vec3 set_back(vec3 light, uint track) {
#if MARKED
    return mix(vec3(0.35 * dot(light, vec3(0.2126, 0.7152, 0.0722))), light, mark_of(track));
#else
    return light;
#endif
}
#endif

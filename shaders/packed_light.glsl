// Linear light in 32 bits, as roots, so that dark colours keep their shades.
uint packed_light(vec3 light) {
    uvec3 root = uvec3(sqrt(clamp(light, 0.0, 1.0)) * vec3(2047.0, 2047.0, 1023.0) + 0.5);
    return root.r << 21 | root.g << 10 | root.b;
}

vec3 unpacked_light(uint number) {
    vec3 root = vec3(number >> 21, (number >> 10) & 2047u, number & 1023u)
              / vec3(2047.0, 2047.0, 1023.0);
    return root * root;
}

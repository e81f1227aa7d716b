// Conversion between sRGB and linear light (IEC 61966-2-1), and packing of colours into 32 bits.

vec3 srgb_to_linear(vec3 srgb) {
    return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), step(0.04045, srgb));
}

vec3 linear_to_srgb(vec3 linear) {
    linear = max(linear, 0.0);
    return mix(linear * 12.92, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055,
               step(0.0031308, linear));
}

// Square roots are stored, since the resolution of linear values would be too low in dark colours.
uint packed_rgb(vec3 linear) {
    uvec3 root = uvec3(sqrt(clamp(linear, 0.0, 1.0)) * vec3(2047.0, 2047.0, 1023.0) + 0.5);
    return root.r << 21 | root.g << 10 | root.b;
}

vec3 unpacked_rgb(uint number) {
    vec3 root = vec3(uvec3(number >> 21, (number >> 10) & 2047u, number & 1023u))
              / vec3(2047.0, 2047.0, 1023.0);
    return root * root;
}

// sRGB and linear light (IEC 61966-2-1).

vec3 srgb_to_linear(vec3 srgb) {
    return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), step(0.04045, srgb));
}

vec3 linear_to_srgb(vec3 linear) {
    linear = max(linear, 0.0);
    return mix(linear * 12.92, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055,
               step(0.0031308, linear));
}

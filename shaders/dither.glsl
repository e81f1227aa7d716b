// Adds interleaved gradient noise (Jimenez 2014), against visible bands in gradients of 8 bits.
vec3 dithered(vec3 color) {
    float wave = fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715)));
    return color + (fract(52.9829189 * wave) - 0.5) / 255.0;
}

// Breaks up the banding of 8-bit gradients (interleaved gradient noise, Jimenez 2014).
float dither() {
    vec2 texel = floor(gl_FragCoord.xy);
    return (fract(52.9829189 * fract(dot(texel, vec2(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

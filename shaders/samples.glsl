// The samples of a pixel side by side in one texel: S of them, from below, from the left.

#define S (SUPERSAMPLE * SUPERSAMPLE)
#if SUPERSAMPLE == 1
#define PACKED float
float[S] unpacked(vec4 texel) { return float[](texel.r); }
float packed_samples(float samples[S]) { return samples[0]; }
#else
#define PACKED vec4
float[S] unpacked(vec4 texel) { return float[](texel.r, texel.g, texel.b, texel.a); }
vec4 packed_samples(float samples[S]) {
    return vec4(samples[0], samples[1], samples[2], samples[3]);
}
#endif

ivec2 place_of(int sample_number) {
    return ivec2(sample_number % SUPERSAMPLE, sample_number / SUPERSAMPLE);
}

// How organs fade: they dissolve. Their points shrink and vanish one after the other, always in the
// same order. Points overlap, so the last few still cover the whole organ; therefore they vanish
// ever more slowly.

#if FADING
uniform float opacity;    // of the organ, from 0 to 1
uniform int first_point;  // number, in its interval, of the first point of what is drawn

const float OVERLAP = 6.0, SHRINKING = 0.3;  // doublings; share of the time that one point takes

// A fixed number in [0, 1) for each point (a multiplicative hash, Knuth 1973).
float hash01(uint point) {
    uint mixed = point * 2654435769u;
    mixed = (mixed ^ (mixed >> 15)) * 2246822519u;
    return float(mixed >> 8) / 16777216.0;
}

#endif

// What is left of a point's radius, from 0 to 1.
float presence(int point) {
#if FADING
    float turn = log2(1.0 + (exp2(OVERLAP) - 1.0) * hash01(uint(first_point + point))) / OVERLAP;
    return clamp((opacity * (1.0 + SHRINKING) - turn) / SHRINKING, 0.0, 1.0);
#else
    return 1.0;
#endif
}

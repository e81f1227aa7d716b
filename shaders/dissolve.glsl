// Fading of organs: their points shrink and vanish one after the other in a fixed random order. A
// few points still cover the organ, because they overlap; therefore points vanish ever more slowly.

#if FADING
uniform float opacity;    // of the organ, from 0 to 1
uniform int first_point;  // index of the first point of the draw call in its interval

const float HALVINGS = 6.0;   // number of times that the points are halved until the organ vanishes
const float SHRINKING = 0.3;  // share of the time in which one point shrinks

// A pseudorandom number in [0, 1) for each point (multiplicative hash, Knuth 1973).
float hash01(uint point) {
    uint mixed = point * 2654435769u;
    mixed = (mixed ^ (mixed >> 15)) * 2246822519u;
    return float(mixed >> 8) / 16777216.0;
}

#endif

// The factor on a point's radius, from 0 to 1.
float presence(int point) {
#if FADING
    float rank = hash01(uint(first_point + point));
    float turn = log2(1.0 + (exp2(HALVINGS) - 1.0) * rank) / HALVINGS;  // when it vanishes
    return clamp((opacity * (1.0 + SHRINKING) - turn) / SHRINKING, 0.0, 1.0);
#else
    return 1.0;
#endif
}

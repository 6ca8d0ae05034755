// Approximates sin(2 pi x) by additions and multiplications only: equal bits on all machines, and loops that call it
// vectorise.
#pragma once

namespace brume {

// x minus the nearest whole number, in [-1/2, 1/2], for |x| < 2^22.
inline float fraction(float x) {
    constexpr float kWhole = 12582912.0f; // 1.5 * 2^23: floats there are whole numbers, so adding it rounds
    return x - ((x + kWhole) - kWhole);
}

// Within 2e-3 of sin(2 pi x); odd, periodic and with a continuous derivative.
inline float sineOfTurns(float x) {
    const float r = fraction(x), r2 = r * r;
    // Zero at 0 and 1/2; the next factor makes it 1 at a quarter turn, with slope 2 pi at 0 and -2 pi at 1/2.
    return r * (0.25f - r2) * (25.132741f + r2 * (-64.297f + 56.13f * r2));
}

} // namespace brume

#include "common/elementary.h"

#include <bit>
#include <cstdint>
#include <numbers>

namespace brume {

// With 1 - x = m 2^-halvings and m in [1/sqrt(2), sqrt(2)): halvings log(2) - log(m). The latter is the series of
// 2 artanh(s) with s = (1 - m) / (1 + m), |s| < 0.1716.
double depthOf(double x) {
    constexpr int kTerms = 11; // the next one is below 1e-17 of the first
    int halvings = 0;
    double m = 1 - x;
    for (; m < 1 / std::numbers::sqrt2; m *= 2) ++halvings;
    // Without halvings 1 - m is x, which 1 - x has rounded.
    const double s = halvings == 0 ? x / (2 - x) : (1 - m) / (1 + m), s2 = s * s;
    double rest = 0;
    for (int i = kTerms; i > 0; --i) rest = s2 * (1.0 / (2 * i + 1) + rest);
    return halvings * std::numbers::ln2 + 2 * (s + s * rest);
}

// Newton's method from a third of the exponent, which is within 5 %: four steps square that down to 1e-20.
double cubeRoot(double x) {
    if (x == 0) return 0;
    constexpr uint64_t kBias = uint64_t{715094163} << 32; // two thirds of the exponent's, less what rounds best
    double root = std::bit_cast<double>(std::bit_cast<uint64_t>(x) / 3 + kBias);
    for (int i = 0; i < 4; ++i) root -= (root - x / (root * root)) / 3;
    return root;
}

// e^x = 2^n e^r with |r| <= log(2) / 2: a Taylor series, whose first term left out is below 1e-17. log(2) has two
// parts, of which the first has so few bits that n times it is exact.
double exponential(double x) {
    constexpr int kTerms = 14;
    constexpr double kLog2 = 0x1.62e42fee00000p-1, kRest = 0x1.a39ef35793c76p-33;
    if (!(x == x)) return x;
    x = x < -700 ? -700 : x > 700 ? 700 : x;
    const double turns = x / std::numbers::ln2;
    const int n = int(turns < 0 ? turns - 0.5 : turns + 0.5);
    const double r = (x - n * kLog2) - n * kRest;
    double sum = 1;
    for (int i = kTerms; i > 0; --i) sum = 1 + r / i * sum;
    return sum * std::bit_cast<double>(uint64_t(1023 + n) << 52);
}

// Of r = x - n pi / 2 with |r| <= pi / 4 both series are short; n says which of them is which, and its sign. pi / 2 has
// two parts, of which the first has so few bits that n times it is exact.
double sine(double x) {
    constexpr int kTerms = 9; // the next one is below 1e-17
    constexpr double kQuarter = 0x1.921fb54400000p+0, kRest = 0x1.0b4611a626331p-34;
    const double turns = x * (2 / std::numbers::pi);
    const auto n = int64_t(turns < 0 ? turns - 0.5 : turns + 0.5);
    const double r = (x - double(n) * kQuarter) - double(n) * kRest, r2 = r * r;
    double even = 1, odd = 1;
    for (int i = kTerms; i > 0; --i) {
        even = 1 - r2 / double((2 * i - 1) * (2 * i)) * even;
        odd = 1 - r2 / double(2 * i * (2 * i + 1)) * odd;
    }
    const double value = n & 1 ? even : r * odd;
    return n & 2 ? -value : value;
}

double cosine(double x) {
    constexpr double kQuarter = 0x1.921fb54400000p+0, kRest = 0x1.0b4611a626331p-34;
    return sine(x + kQuarter + kRest);
}

} // namespace brume

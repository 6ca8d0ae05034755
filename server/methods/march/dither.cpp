#include "server/methods/march/dither.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace brume {
namespace {

constexpr uint32_t kPixels = kDitherSide * kDitherSide;

// `numbers` of `count` different values, as offsets: the middles of so many parts of (0, 1).
std::vector<float> offsetsOf(const std::vector<uint32_t>& numbers, uint32_t count) {
    std::vector<float> offsets(numbers.size());
    std::ranges::transform(numbers, offsets.begin(), [&](uint32_t n) { return (float(n) + 0.5f) / float(count); });
    return offsets;
}

std::vector<float> bayer(uint32_t levels) {
    std::vector<uint32_t> numbers(kPixels);
    for (uint32_t i = 0; i < kPixels; ++i) numbers[i] = bayerNumber(i % kDitherSide, i / kDitherSide, levels);
    return offsetsOf(numbers, 1u << 2 * levels);
}

std::vector<float> white() {
    constexpr uint32_t kSide = 8, kNumbers = kSide * kSide;
    std::vector<uint32_t> shuffled(kNumbers), numbers(kPixels);
    std::iota(shuffled.begin(), shuffled.end(), 0u);
    std::mt19937 bits(5); // NOLINT(cert-msc32-c,cert-msc51-cpp): a usual shuffle, the same everywhere
    for (auto i = uint32_t(shuffled.size()); i-- > 1;) std::swap(shuffled[i], shuffled[bits() % (i + 1)]);
    for (uint32_t i = 0; i < kPixels; ++i)
        numbers[i] = shuffled[size_t(i) / kDitherSide % kSide * kSide + i % kDitherSide % kSide];
    return offsetsOf(numbers, kNumbers);
}

// Pixels that are set on a torus, and how crowded each place is: a sum of Gaussians around them.
class Crowd {
public:
    Crowd() : set_(kPixels, 0), crowded_(kPixels, 0), gaussian_(kPixels) {
        constexpr double kDeviation = 1.5; // pixels, as Ulichney's
        for (uint32_t i = 0; i < kPixels; ++i) {
            const uint32_t x = i % kDitherSide, y = i / kDitherSide;
            const double dx = std::min(x, kDitherSide - x), dy = std::min(y, kDitherSide - y);
            gaussian_[i] = std::exp(-(dx * dx + dy * dy) / (2 * kDeviation * kDeviation));
        }
    }
    bool isSet(uint32_t i) const { return set_[i] != 0; }
    void flip(uint32_t i) {
        const double sign = isSet(i) ? -1 : 1;
        set_[i] ^= 1;
        const uint32_t x = i % kDitherSide, y = i / kDitherSide;
        for (uint32_t row = 0; row < kDitherSide; ++row) {
            const double* from = &gaussian_[size_t(row + kDitherSide - y) % kDitherSide * kDitherSide];
            double* to = &crowded_[size_t(row) * kDitherSide];
            for (uint32_t column = 0; column < kDitherSide; ++column)
                to[column] += sign * from[(column + kDitherSide - x) % kDitherSide];
        }
    }
    // The most crowded pixel that is set; the first of several.
    uint32_t cluster() const {
        uint32_t most = kPixels;
        for (uint32_t i = 0; i < kPixels; ++i)
            if (isSet(i) && (most == kPixels || crowded_[i] > crowded_[most])) most = i;
        return most;
    }
    // The least crowded pixel that is not set.
    uint32_t gap() const {
        uint32_t least = kPixels;
        for (uint32_t i = 0; i < kPixels; ++i)
            if (!isSet(i) && (least == kPixels || crowded_[i] < crowded_[least])) least = i;
        return least;
    }

private:
    std::vector<uint8_t> set_;
    std::vector<double> crowded_, gaussian_;
};

std::vector<float> blue() {
    constexpr uint32_t kFirst = kPixels / 10; // pixels of the pattern that is spread evenly at first
    Crowd spread;
    std::mt19937 bits(64); // NOLINT(cert-msc32-c,cert-msc51-cpp): the same pattern everywhere
    for (uint32_t set = 0; set < kFirst;) {
        const uint32_t i = bits() % kPixels;
        if (spread.isSet(i)) continue;
        spread.flip(i);
        ++set;
    }
    for (uint32_t moved = 0; moved < kPixels; ++moved) { // the most crowded one moves to the largest gap
        const uint32_t from = spread.cluster();
        spread.flip(from);
        const uint32_t to = spread.gap();
        spread.flip(to);
        if (from == to) break;
    }
    std::vector<uint32_t> numbers(kPixels);
    Crowd fewer = spread;
    for (uint32_t number = kFirst; number-- > 0;) {
        const uint32_t i = fewer.cluster();
        fewer.flip(i);
        numbers[i] = number;
    }
    for (uint32_t number = kFirst; number < kPixels; ++number) {
        const uint32_t i = spread.gap();
        spread.flip(i);
        numbers[i] = number;
    }
    return offsetsOf(numbers, kPixels);
}

} // namespace

uint32_t bayerNumber(uint32_t x, uint32_t y, uint32_t levels) {
    uint32_t number = 0; // the lowest bits of x and y decide its highest ones
    for (uint32_t level = 0; level < levels; ++level) {
        const uint32_t right = x >> level & 1, down = y >> level & 1;
        number = number << 2 | (right ^ down) << 1 | down;
    }
    return number;
}

std::vector<float> ditherTable(std::string_view pattern) {
    if (pattern == "bayer4") return bayer(2);
    if (pattern == "bayer8") return bayer(3);
    if (pattern == "white") return white();
    if (pattern == "blue") return blue();
    return std::vector<float>(kPixels, 0.5f);
}

} // namespace brume

// Patterns and filters of method march: what a filter leaves of a pattern.
#include "server/methods/march/dither.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "shaders/shared/march.h"

namespace brume {
namespace {

constexpr int kSide = 64;
using Square = std::vector<double>; // [row][column], repeated

// A filter's weights, which sum to 1.
std::vector<double> weightsOf(uint32_t blur) {
    const auto& printed = gpu::kBlurWeights[blur];
    std::vector<double> weights(std::begin(printed), std::end(printed));
    double sum = 0;
    for (const double w : weights) sum += w;
    for (double& w : weights) w /= sum;
    return weights;
}

double varianceOf(const std::vector<double>& weights) {
    double mean = 0, square = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
        mean += weights[i] * double(i);
        square += weights[i] * double(i * i);
    }
    return square - mean * mean;
}

// Along rows, then down columns.
Square blurred(Square square, uint32_t blur) {
    const std::vector<double> weights = weightsOf(blur);
    for (const bool down : {false, true}) {
        Square next(square.size(), 0);
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x)
                for (int k = 0; k < int(weights.size()); ++k) {
                    const int off = k - int(gpu::kBlurReach) + kSide;
                    const int u = down ? x : (x + off) % kSide, v = down ? (y + off) % kSide : y;
                    next[size_t(y * kSide + x)] += weights[size_t(k)] * square[size_t(v * kSide + u)];
                }
        square = next;
    }
    return square;
}

double deviationOf(const Square& square) {
    double sum = 0, squares = 0;
    for (const double v : square) sum += v;
    const double mean = sum / double(square.size());
    for (const double v : square) squares += (v - mean) * (v - mean);
    return std::sqrt(squares / double(square.size()));
}

Square patternOf(const std::string& name) {
    Square square(size_t(kSide) * kSide);
    if (name == "ign") { // not repeated after 64 pixels: the seam counts little
        for (size_t i = 0; i < square.size(); ++i)
            square[i] = physics::interleavedNoise(double(i % kSide), double(i / kSide)); // NOLINT
    } else {
        const std::vector<float> table = ditherTable(name);
        std::ranges::copy(table, square.begin());
    }
    return square;
}

struct Residue {
    double ramp, edge; // standard deviation, in parts of what changes within a step
};

// What a filter leaves where a quantity grows along each step, and where it ends within each step: there the mean
// square over places of the edge.
Residue residueOf(const Square& pattern, uint32_t blur) {
    double squares = 0;
    constexpr int kEdges = 64;
    for (int e = 0; e < kEdges; ++e) {
        Square edge(pattern.size());
        std::ranges::transform(pattern, edge.begin(), [&](double d) { return d < double(e) / kEdges ? 1.0 : 0.0; });
        const double deviation = deviationOf(blurred(edge, blur));
        squares += deviation * deviation / kEdges;
    }
    return {deviationOf(blurred(pattern, blur)), std::sqrt(squares)};
}

// The matrix of twice the side: four times the smaller one, and 0, 2, 3, 1 in the quarters of each cell.
uint32_t bayerByRecursion(uint32_t x, uint32_t y, uint32_t side) {
    if (side == 1) return 0;
    const uint32_t half = side / 2, quarter = (y / half) * 2 + x / half;
    constexpr uint32_t kQuarters[] = {0, 2, 3, 1};
    return 4 * bayerByRecursion(x % half, y % half, half) + kQuarters[quarter];
}

TEST(DitherTest, BayersMatrixIsThatOfTheRecursion) {
    for (const uint32_t levels : {1u, 2u, 3u, 4u}) {
        const uint32_t side = 1u << levels;
        std::set<uint32_t> numbers;
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x) {
                EXPECT_EQ(bayerNumber(x, y, levels), bayerByRecursion(x, y, side)) << x << ' ' << y;
                numbers.insert(bayerNumber(x, y, levels));
            }
        EXPECT_EQ(numbers.size(), side * side);
        EXPECT_EQ(*numbers.rbegin(), side * side - 1);
    }
}

// The offsets that the thesis prints, id / 64, pull all samples toward the eye.
TEST(DitherTest, OffsetsHaveTheMeanOfTheMiddle) {
    for (const char* name : {"none", "white", "bayer4", "bayer8", "ign", "blue"}) {
        double sum = 0;
        for (const float v : ditherTable(name)) {
            EXPECT_GT(v, 0) << name;
            EXPECT_LT(v, 1) << name;
            sum += double(v);
        }
        EXPECT_EQ(sum / (kSide * kSide), 0.5) << name;
    }
    double printed = 0;
    for (uint32_t i = 0; i < 64; ++i) printed += bayerNumber(i % 8, i / 8, 3) / 64.0 / 64;
    EXPECT_EQ(printed, 0.5 - 1.0 / 128);
}

TEST(DitherTest, WhiteIsOneShuffleRepeatedAndBlueIsNotRepeated) {
    const std::vector<float> white = ditherTable("white"), blue = ditherTable("blue");
    std::set<float> cell;
    for (size_t y = 0; y < kSide; ++y)
        for (size_t x = 0; x < kSide; ++x) {
            EXPECT_EQ(white[y * kSide + x], white[y % 8 * kSide + x % 8]);
            cell.insert(white[y * kSide + x]);
        }
    EXPECT_EQ(cell.size(), 64u);
    EXPECT_EQ(std::set<float>(blue.begin(), blue.end()).size(), size_t(kSide) * kSide);
    EXPECT_EQ(ditherTable("blue"), blue);
}

TEST(DitherTest, VariancesOfFilters) {
    EXPECT_NEAR(varianceOf(weightsOf(gpu::kBlurRow14)), 3.5, 1e-12);
    EXPECT_NEAR(varianceOf(weightsOf(gpu::kBlurPrinted)), 3.02, 0.005);
    EXPECT_NEAR(varianceOf(weightsOf(gpu::kBlurBox8)), 63.0 / 12, 1e-12);
}

// Bayer's strongest frequencies are where a binomial filter lets nothing through. Eight even taps take every number
// once, whichever their order.
TEST(DitherTest, ResiduesBehindFilters) {
    const struct {
        const char* pattern;
        Residue row14, printed;
        bool repeated; // True: its numbers are those of 8x8 pixels
    } kExpected[] = {{"bayer8", {0.0028, 0.0084}, {0.0044, 0.0119}, true},
                     {"bayer4", {0.0002, 0.0007}, {0.0026, 0.0056}, true},
                     {"white", {0.0251, 0.0356}, {0.0314, 0.0446}, true},
                     {"ign", {0.0107, 0.0150}, {0.0127, 0.0177}, false},
                     {"blue", {0.0009, 0.0105}, {0.0029, 0.0130}, false}};
    for (const auto& e : kExpected) {
        const Square pattern = patternOf(e.pattern);
        const Residue row14 = residueOf(pattern, gpu::kBlurRow14), printed = residueOf(pattern, gpu::kBlurPrinted),
                      even = residueOf(pattern, gpu::kBlurBox8);
        std::printf("%-7s row14 %.4f, %.4f; printed %.4f, %.4f; box8 %.4f, %.4f\n", e.pattern, row14.ramp, row14.edge,
                    printed.ramp, printed.edge, even.ramp, even.edge);
        constexpr double kDigits = 0.00005; // of the table
        EXPECT_NEAR(row14.ramp, e.row14.ramp, 0.05 * e.row14.ramp + kDigits) << e.pattern;
        EXPECT_NEAR(row14.edge, e.row14.edge, 0.05 * e.row14.edge + kDigits) << e.pattern;
        EXPECT_NEAR(printed.ramp, e.printed.ramp, 0.05 * e.printed.ramp + kDigits) << e.pattern;
        EXPECT_NEAR(printed.edge, e.printed.edge, 0.05 * e.printed.edge + kDigits) << e.pattern;
        EXPECT_EQ(even.ramp < 1e-7 && even.edge < 1e-7, e.repeated) << e.pattern;
    }
}

// The thesis's comparison, by numbers: Bayer's pattern against any shuffle of the same numbers.
TEST(DitherTest, AShuffleLeavesEightTimesAsMuchAsBayer) {
    const double bayer = residueOf(patternOf("bayer8"), gpu::kBlurRow14).ramp;
    double squares = 0;
    constexpr int kShuffles = 200;
    std::mt19937 bits(1);
    std::vector<double> numbers(64);
    for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = (double(i) + 0.5) / 64;
    Square square(size_t(kSide) * kSide);
    for (int n = 0; n < kShuffles; ++n) {
        std::shuffle(numbers.begin(), numbers.end(), bits);
        for (size_t i = 0; i < square.size(); ++i) square[i] = numbers[i / kSide % 8 * 8 + i % 8];
        const double deviation = deviationOf(blurred(square, gpu::kBlurRow14));
        squares += deviation * deviation / kShuffles;
    }
    std::printf("a shuffle leaves %.1f times as much\n", std::sqrt(squares) / bayer);
    EXPECT_GE(std::sqrt(squares) / bayer, 8);
    // The shuffle that is drawn with is a usual one.
    EXPECT_NEAR(residueOf(patternOf("white"), gpu::kBlurRow14).ramp, std::sqrt(squares), 0.1 * std::sqrt(squares));
}

} // namespace
} // namespace brume

// Weights of a Gaussian of any axes at voxels, in rows of eight. For hot loops, so they are inline.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "tools/import/mixture.h"
#include "tools/import/weights.h"

namespace brume::volumes {

// Eight numbers along z, of one row of a block. GCC and Clang have such vectors; both unroll loops over eight numbers
// instead of vectorizing them.
using Row = float __attribute__((vector_size(kSide * sizeof(float))));
using RowOfWhole = int32_t __attribute__((vector_size(kSide * sizeof(int32_t))));

// exp(x) of each to 2e-7 of it, for x from -80 to 0: 2^n times the polynomial of Cephes' expf.
inline void exponentiate(Row& x) {
    const RowOfWhole exponent = __builtin_convertvector(x * 1.44269504f - 0.5f, RowOfWhole); // the nearest: x <= 0
    const Row n = __builtin_convertvector(exponent, Row);
    const Row r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
    Row p = 1.9875691500e-4f * r + 1.3981999507e-3f;
    p = p * r + 8.3334519073e-3f;
    p = p * r + 4.1665795894e-2f;
    p = p * r + 1.6666665459e-1f;
    p = p * r + 5.0000001201e-1f;
    p = p * r * r + r + 1.0f;
    const RowOfWhole bits = (exponent + 127) << 23;
    Row power_of_two{};
    std::memcpy(&power_of_two, &bits, sizeof bits);
    x = p * power_of_two;
}

inline double sumOf(const Row& row) {
    double sum = 0;
    for (int k = 0; k < kSide; ++k) sum += double(row[k]);
    return sum;
}

class EllipsoidWeights {
public:
    static constexpr double kReach = 4; // deviations, where the Gaussian ends

    explicit EllipsoidWeights(const Kernel& kernel) : at_(kernel.at), precision_(glm::inverse(kernel.spread)) {
        for (int axis = 0; axis < 3; ++axis) {
            const double far = kReach * std::sqrt(kernel.spread[axis][axis]);
            first_[axis] = int(std::ceil(at_[axis] - far));
            last_[axis] = int(std::floor(at_[axis] + far));
        }
        // The sum over the voxels' centres is the integral unless some axis is short; the trace is above its precision.
        const double integral = std::sqrt(std::pow(2 * std::numbers::pi, 3) * glm::determinant(kernel.spread));
        const bool wide = precision_[0][0] + precision_[1][1] + precision_[2][2] < 1 / (kWide * kWide);
        scale_ = float(1 / (wide ? kWithin * integral : sum()));
    }

    glm::ivec3 first() const { return first_; } // voxels within reach lie between these
    glm::ivec3 last() const { return last_; }

    // Adds the Gaussian's part of one block, whose first voxel is `origin`. All moments are hardly dearer than the
    // mass.
    void gather(const float* values, glm::ivec3 origin, bool /*shape*/, Moments& out) const {
        Row mass{}, x_of{}, y_of{};
        glm::dvec3 across(0); // sums of xx, xy, yy
        forRows(origin, [&](int x, int y, const Row& weights) {
            const double dx = x - at_.x, dy = y - at_.y;
            Row part{};
            std::memcpy(&part, values + inBlock({x, y, origin.z}), sizeof part);
            part *= weights;
            mass += part;
            x_of += float(dx) * part;
            y_of += float(dy) * part;
            across += sumOf(part) * glm::dvec3(dx * dx, dx * dy, dy * dy);
        });
        glm::dvec3 with_z(0); // sums of xz, yz, zz
        for (int k = 0; k < kSide; ++k) {
            const double dz = origin.z + k - at_.z;
            const glm::dvec3 part(x_of[k], y_of[k], dz * double(mass[k]));
            out.mass += double(mass[k]);
            out.first += part;
            with_z += dz * part;
        }
        out.second +=
            glm::dmat3(across.x, across.y, with_z.x, across.y, across.z, with_z.y, with_z.x, with_z.y, with_z.z);
    }

    void scatter(float* values, glm::ivec3 origin, float mass) const {
        forRows(origin, [&](int x, int y, const Row& weights) {
            float* const row = values + inBlock({x, y, origin.z});
            Row sum{};
            std::memcpy(&sum, row, sizeof sum);
            sum += mass * weights;
            std::memcpy(row, &sum, sizeof sum);
        });
    }

private:
    static constexpr double kWithin = 0.998866; // of the mass: erf(r / sqrt 2) - sqrt(2 / pi) r exp(-r^2 / 2)
    static constexpr double kWide = 0.6;        // voxels
    static constexpr float kEnd = float(-0.5 * kReach * kReach);
    static constexpr Row kZero{}, kIndex{0, 1, 2, 3, 4, 5, 6, 7};

    // Weights of (x, y, z) and the seven voxels behind. False: all are 0.
    bool row(int x, int y, int z, Row& out) const {
        // The exponent is `peak` at the row's middle, and falls as a parabola from there.
        const double dx = x - at_.x, dy = y - at_.y, of_z = precision_[2][2];
        const double slope = -(precision_[0][2] * dx + precision_[1][2] * dy);
        const auto peak = float(0.5 * (slope * slope / of_z - precision_[0][0] * dx * dx - precision_[1][1] * dy * dy) -
                                precision_[0][1] * dx * dy);
        if (peak < kEnd) return false;
        const auto middle = float(slope / of_z + at_.z - z), half = float(-0.5 * of_z);
        const Row d = kIndex - middle;
        Row power = peak + half * d * d;
        const auto within = power > kEnd;
        power = within ? power : kZero + kEnd;
        exponentiate(power);
        out = within ? scale_ * power : kZero;
        return true;
    }

    // Calls visit(x, y, weights) for each row of a block that is within reach.
    template <class Visit>
    void forRows(glm::ivec3 origin, const Visit& visit) const {
        Row weights{};
        for (int x = std::max(first_.x, origin.x); x <= std::min(last_.x, origin.x + kSide - 1); ++x)
            for (int y = std::max(first_.y, origin.y); y <= std::min(last_.y, origin.y + kSide - 1); ++y)
                if (row(x, y, origin.z, weights)) visit(x, y, weights);
    }

    double sum() {
        scale_ = 1;
        Row weights{};
        double out = 0;
        for (int x = first_.x; x <= last_.x; ++x)
            for (int y = first_.y; y <= last_.y; ++y)
                for (int z = first_.z; z <= last_.z; z += kSide)
                    if (row(x, y, z, weights)) out += sumOf(weights);
        return out;
    }

    glm::dvec3 at_;
    glm::dmat3 precision_;
    glm::ivec3 first_, last_;
    float scale_ = 1; // what a weight of 1 becomes
};

} // namespace brume::volumes

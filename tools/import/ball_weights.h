// Weights of a Gaussian ball at voxels: a product of three, one along each axis. For hot loops, so they are inline.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tools/import/mixture.h"
#include "tools/import/weights.h"

namespace brume::volumes {

class BallWeights {
public:
    static constexpr double kReach = 3.4; // deviations, where the ball ends, fallen to 0.3 %

    explicit BallWeights(const Kernel& kernel) : at_(kernel.at) {
        const double deviation = std::sqrt(kernel.spread[0][0]);
        x_.set(at_.x, deviation, false);
        y_.set(at_.y, deviation, false);
        z_.set(at_.z, deviation, true);
    }

    glm::ivec3 first() const { return {x_.first, y_.first, z_.first}; } // voxels within reach lie between these
    glm::ivec3 last() const { return {x_.end - 1, y_.end - 1, z_.end - 1}; }

    // Adds the Gaussian's part of one block, whose first voxel is `origin`. `shape`: moments beside the mass, too.
    void gather(const float* values, glm::ivec3 origin, bool shape, Moments& out) const {
        if (shape)
            gather<true>(values, origin, out);
        else
            gather<false>(values, origin, out);
    }

    void scatter(float* values, glm::ivec3 origin, float mass) const {
        const int x_from = std::max(x_.first, origin.x), x_to = std::min(x_.end, origin.x + kSide);
        const int y_from = std::max(y_.first, origin.y), y_to = std::min(y_.end, origin.y + kSide);
        const float* const wz = &z_.w[size_t(origin.z - z_.first)];
        for (int x = x_from; x < x_to; ++x)
            for (int y = y_from; y < y_to; ++y) {
                const float w = mass * x_.at(x) * y_.at(y);
                float* const row = values + inBlock({x, y, origin.z});
                for (size_t z = 0; z < kSide; ++z) row[z] += w * wz[z];
            }
    }

private:
    static constexpr size_t kMostTaps = 576; // of the widest one, at level kLevels - 1, and eight more at each end

    // Weights along one axis. They add up to 1.
    struct Taps {
        int first = 0, end = 0;           // voxels
        std::array<float, kMostTaps> w{}; // of voxel `first` and those after it

        float at(int voxel) const { return w[size_t(voxel - first)]; }
        // `whole_blocks`: zeros up to the ends of the first and the last block.
        void set(double at, double deviation, bool whole_blocks) {
            const int lo = int(std::ceil(at - kReach * deviation)), hi = int(std::floor(at + kReach * deviation));
            first = whole_blocks ? (lo >> 3) * kSide : lo;
            end = whole_blocks ? ((hi >> 3) + 1) * kSide : hi + 1;
            const double fall = -0.5 / (deviation * deviation);
            double sum = 0;
            for (int i = first; i < end; ++i) {
                const double d = double(i) - at;
                const double value = i < lo || i > hi ? 0 : std::exp(fall * d * d);
                sum += value;
                w[size_t(i - first)] = float(value);
            }
            const auto scale = float(1 / sum);
            for (int i = first; i < end; ++i) w[size_t(i - first)] *= scale;
        }
    };

    template <bool shape>
    void gather(const float* values, glm::ivec3 origin, Moments& out) const {
        const int x_from = std::max(x_.first, origin.x), x_to = std::min(x_.end, origin.x + kSide);
        const int y_from = std::max(y_.first, origin.y), y_to = std::min(y_.end, origin.y + kSide);
        const float* const wz = &z_.w[size_t(origin.z - z_.first)];
        std::array<float, kSide * kSide> over_x{};
        for (int x = x_from; x < x_to; ++x) {
            const float wx = x_.at(x);
            std::array<float, kSide> over_y{};
            for (int y = y_from; y < y_to; ++y) {
                const float wy = y_.at(y);
                const float* const row = values + inBlock({x, y, origin.z});
                for (size_t z = 0; z < kSide; ++z) over_y[z] += wy * row[z];
                if constexpr (shape) {
                    float* const sum = &over_x[size_t(y - origin.y) * kSide];
                    for (size_t z = 0; z < kSide; ++z) sum[z] += wx * row[z];
                }
            }
            float slice = 0;
            for (size_t z = 0; z < kSide; ++z) slice += wz[z] * over_y[z];
            const double part = double(wx * slice), d = double(x) - at_.x;
            out.mass += part;
            out.first.x += d * part;
            out.second[0][0] += d * d * part;
        }
        if constexpr (shape) {
            std::array<float, kSide> over_xy{};
            for (int y = y_from; y < y_to; ++y) {
                const float wy = y_.at(y);
                const float* const row = &over_x[size_t(y - origin.y) * kSide];
                float slice = 0;
                for (size_t z = 0; z < kSide; ++z) {
                    slice += wz[z] * row[z];
                    over_xy[z] += wy * row[z];
                }
                const double part = double(wy * slice), d = double(y) - at_.y;
                out.first.y += d * part;
                out.second[1][1] += d * d * part;
            }
            for (int z = 0; z < kSide; ++z) {
                const double part = double(wz[z] * over_xy[size_t(z)]), d = double(origin.z + z) - at_.z;
                out.first.z += d * part;
                out.second[2][2] += d * d * part;
            }
        }
    }

    glm::dvec3 at_;
    Taps x_, y_, z_;
};

} // namespace brume::volumes

#include "tools/import/path.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace brume::volumes {

namespace {

// The eight voxels around a cell between voxels' centres, of the blocks that a run of cells needs.
class Corners {
public:
    Corners(const Voxels& voxels, std::span<const float> values) : voxels_(voxels), values_(values) {}

    // False: all are 0.
    bool of(glm::ivec3 cell, std::array<double, 8>& out) {
        if (const glm::ivec3 block = cell >> 3; block != block_) {
            block_ = block;
            some_ = false;
            for (int n = 0; n < 8; ++n) {
                blocks_[size_t(n)] = voxels_.find(block + glm::ivec3(n & 1, n >> 1 & 1, n >> 2));
                some_ = some_ || blocks_[size_t(n)] != kNoBlock;
            }
        }
        if (!some_) return false;
        for (int n = 0; n < 8; ++n) {
            const glm::ivec3 in = (cell & 7) + glm::ivec3(n & 1, n >> 1 & 1, n >> 2);
            const glm::ivec3 over = in >> 3;
            const uint32_t block = blocks_[static_cast<unsigned>(over.x + 2 * over.y + 4 * over.z)];
            out[size_t(n)] = block == kNoBlock ? 0 : double(values_[block * kInBlock + inBlock(in)]);
        }
        return true;
    }

private:
    const Voxels& voxels_;
    std::span<const float> values_;
    glm::ivec3 block_{std::numeric_limits<int>::max()};
    std::array<uint32_t, 8> blocks_{};
    bool some_ = false;
};

double interpolated(const std::array<double, 8>& c, glm::dvec3 part) {
    const glm::dvec3 rest = 1.0 - part;
    return rest.z * (rest.y * (rest.x * c[0] + part.x * c[1]) + part.y * (rest.x * c[2] + part.x * c[3])) +
           part.z * (rest.y * (rest.x * c[4] + part.x * c[5]) + part.y * (rest.x * c[6] + part.x * c[7]));
}

} // namespace

glm::dvec3 acrossOf(glm::dvec3 toward) {
    const glm::dvec3 other = std::abs(toward.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::normalize(glm::cross(toward, other));
}

Part partWithin(const Voxels& voxels, glm::dvec3 through, glm::dvec3 toward) {
    Part part;
    const glm::dvec3 lo(voxels.lo() - 1), hi(voxels.hi() + 1);
    for (int axis = 0; axis < 3; ++axis) {
        if (toward[axis] == 0) {
            if (through[axis] < lo[axis] || through[axis] >= hi[axis]) return {0, 0};
            continue;
        }
        const double a = (lo[axis] - through[axis]) / toward[axis], b = (hi[axis] - through[axis]) / toward[axis];
        part.from = std::max(part.from, std::min(a, b));
        part.to = std::min(part.to, std::max(a, b));
    }
    return part;
}

double integralAlong(const Voxels& voxels, std::span<const float> of, glm::dvec3 through, glm::dvec3 toward,
                     Part part) {
    const Part within = partWithin(voxels, through, toward);
    double t = std::max(part.from, within.from);
    const double end = std::min(part.to, within.to);
    if (!(t < end)) return 0;
    const glm::dvec3 lo(voxels.lo() - 1), hi(voxels.hi() + 1);
    // From cell to cell. In each the values along the line are a cubic, which Simpson's rule integrates exactly.
    glm::ivec3 cell, step;
    glm::dvec3 next, between;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = std::clamp(through[axis] + t * toward[axis], lo[axis], hi[axis] - 1e-9);
        cell[axis] = int(std::floor(at));
        step[axis] = toward[axis] > 0 ? 1 : -1;
        between[axis] = toward[axis] == 0 ? std::numeric_limits<double>::max() : 1 / std::abs(toward[axis]);
        next[axis] = toward[axis] == 0 ? std::numeric_limits<double>::max()
                                       : (double(cell[axis] + (toward[axis] > 0)) - through[axis]) / toward[axis];
    }
    Corners corners(voxels, of);
    std::array<double, 8> values{};
    double sum = 0;
    while (t < end) {
        const int axis = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
        const double leave = std::min(next[axis], end);
        if (leave > t && corners.of(cell, values)) {
            const auto value = [&](double s) { return interpolated(values, through + s * toward - glm::dvec3(cell)); };
            sum += (leave - t) / 6 * (value(t) + 4 * value((t + leave) / 2) + value(leave));
        }
        t = std::max(t, leave);
        cell[axis] += step[axis];
        next[axis] += between[axis];
    }
    return sum;
}

double integralAlong(const Voxels& voxels, glm::dvec3 through, glm::dvec3 toward) {
    return integralAlong(voxels, voxels.values(), through, toward, {});
}

} // namespace brume::volumes

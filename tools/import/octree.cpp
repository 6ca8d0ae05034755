#include "tools/import/octree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::volumes {

namespace {

constexpr int kRounds = 6; // of the lattices that tell what is left; more change hardly a choice

enum class Choice : uint8_t { none, one, parts };

// Sums of a block's columns, each within a cell of `width` voxels: their squares, weighted. `to` gets one number for
// each cell of the block.
void squares(const float* values, const float* less, glm::ivec3 origin, int width, const ColumnWeights& weights,
             std::vector<float>& to) {
    const int parts = kSide / width;
    to.assign(static_cast<unsigned>(parts * parts * parts), 0);
    for (int axis = 0; axis < 3; ++axis)
        for (int column = 0; column < kSide * kSide; ++column) {
            glm::ivec3 in(0);
            in[(axis + 1) % 3] = column / kSide, in[(axis + 2) % 3] = column % kSide;
            const double weight = weights.of(axis, origin + in);
            for (int part = 0; part < parts; ++part) {
                double sum = 0;
                for (int k = part * width; k < (part + 1) * width; ++k) {
                    in[axis] = k;
                    const size_t n = inBlock(in);
                    sum += double(values[n]) - (less ? double(less[n]) : 0);
                }
                const glm::ivec3 cell = in / width;
                to[static_cast<unsigned>((cell.x * parts + cell.y) * parts + cell.z)] += float(weight * sum * sum);
            }
        }
}

} // namespace

// An error d of a depth counts as d^2 / (sum of all depths^2). It changes what is stopped by exp(-depth) d, and that
// counts as its square / (sum of what is stopped, squared).
ColumnWeights::ColumnWeights(const Voxels& voxels, double per_value)
    : lo_(voxels.lo()), size_(voxels.hi() - voxels.lo() + 1) {
    for (int axis = 0; axis < 3; ++axis)
        of_[size_t(axis)].assign(size_t(size_[(axis + 1) % 3]) * size_t(size_[(axis + 2) % 3]), 0);
    forActive(voxels, [&](glm::ivec3 voxel, float value) {
        for (int axis = 0; axis < 3; ++axis) of_[size_t(axis)][index(axis, voxel)] += per_value * double(value);
    });
    double depths = 0, stopped = 0;
    for (const std::vector<double>& of : of_)
        for (const double depth : of) {
            depths += depth * depth;
            stopped += std::expm1(-depth) * std::expm1(-depth);
        }
    for (std::vector<double>& of : of_)
        for (double& depth : of) depth = per_value * per_value * (1 / depths + std::exp(-2 * depth) / stopped);
}

template <class Visit>
void Octree::forParts(const Cell& cell, const Visit& visit) const {
    const float* const block = &voxels_.values()[voxels_.find(cell.at >> 2) * kInBlock];
    for (int n = 0; n < 8; ++n) {
        const glm::ivec3 voxel = cell.at * 2 + glm::ivec3(n >> 2, n >> 1 & 1, n & 1);
        const float value = block[inBlock(voxel)];
        if (!(value > 0)) continue;
        double weight = 0;
        for (int axis = 0; axis < 3; ++axis) weight += weights_.of(axis, voxel);
        visit(voxel, value, weight * double(value) * double(value));
    }
}

Octree::Octree(const Voxels& voxels, Shape shape, double per_value, bool ellipsoids)
    : voxels_(voxels), shape_(shape), follow_(ellipsoids ? Follow::place_and_axes : Follow::nothing),
      weights_(voxels, per_value) {
    for (int level = 1; level < kLevels; ++level) {
        makeCells(level);
        measure(level);
    }
}

void Octree::makeCells(int level) {
    std::vector<Cell>& cells = cells_[size_t(level)];
    if (level == 1) {
        constexpr int kParts = kSide / 2;
        for (size_t block = 0; block < voxels_.blocks().size(); ++block)
            for (int n = 0; n < kParts * kParts * kParts; ++n) {
                Cell cell;
                cell.at = voxels_.blocks()[block] * kParts + glm::ivec3(n / 16, n / 4 % 4, n % 4);
                forParts(cell, [&](glm::ivec3, float value, double) { cell.mass += value; });
                cell.morton = mortonOf(cell.at);
                if (cell.mass > 0) cells.push_back(cell);
            }
        std::ranges::sort(cells, {}, &Cell::morton);
        return;
    }
    const std::vector<Cell>& below = cells_[size_t(level) - 1];
    for (uint32_t i = 0; i < below.size(); ++i) {
        const glm::ivec3 at = below[i].at >> 1;
        if (cells.empty() || cells.back().at != at) cells.push_back({.morton = mortonOf(at), .at = at, .first = i});
        cells.back().end = i + 1;
        cells.back().mass += below[i].mass;
    }
}

void Octree::measure(int level) {
    std::vector<Cell>& cells = cells_[size_t(level)];
    std::vector<Kernel> kernels;
    kernels.reserve(cells.size());
    for (const Cell& cell : cells) kernels.push_back(kernelOf(shape_, level, cell.at, cell.mass));
    Mixture lattice(voxels_, shape_, std::move(kernels));
    lattice.refine(kRounds, follow_);
    const std::vector<float> sums = lattice.sums();
    const int width = std::min(1 << level, kSide), parts = kSide / width;
    std::vector<float> left, without;
    for (size_t block = 0; block < voxels_.blocks().size(); ++block) {
        const float* const values = &voxels_.values()[block * kInBlock];
        const glm::ivec3 origin = voxels_.blocks()[block] * kSide;
        squares(values, &sums[block * kInBlock], origin, width, weights_, left);
        squares(values, nullptr, origin, width, weights_, without);
        for (int n = 0; n < parts * parts * parts; ++n) {
            const glm::ivec3 voxel = origin + glm::ivec3(n / parts / parts, n / parts % parts, n % parts) * width;
            const auto cell = std::ranges::lower_bound(cells, mortonOf(voxel >> level), {}, &Cell::morton);
            if (cell == cells.end() || cell->at != voxel >> level) continue;
            cell->left += left[size_t(n)];
            cell->without += without[size_t(n)];
        }
    }
}

std::vector<Kernel> Octree::choose(double price) const {
    std::array<std::vector<Choice>, kLevels> choices;
    std::vector<double> costs, below; // of the level's cells, and of the level's below
    for (int level = 1; level < kLevels; ++level) {
        const std::vector<Cell>& cells = cells_[size_t(level)];
        below.swap(costs);
        costs.assign(cells.size(), 0);
        choices[size_t(level)].assign(cells.size(), Choice::none);
        for (size_t i = 0; i < cells.size(); ++i) {
            const Cell& cell = cells[i];
            double parts = 0;
            if (level == 1)
                forParts(cell, [&](glm::ivec3, float, double without) { parts += std::min(without, price); });
            else
                for (uint32_t n = cell.first; n < cell.end; ++n) parts += below[n];
            const double one = double(cell.left) + price;
            costs[i] = std::min({double(cell.without), one, parts});
            if (costs[i] < double(cell.without)) choices[size_t(level)][i] = one <= parts ? Choice::one : Choice::parts;
        }
    }
    std::vector<Kernel> out;
    const auto take = [&](const auto& self, int level, uint32_t i) -> void {
        const Cell& cell = cells_[size_t(level)][i];
        const Choice choice = choices[size_t(level)][i];
        if (choice == Choice::one) out.push_back(kernelOf(shape_, level, cell.at, cell.mass));
        if (choice != Choice::parts) return;
        for (uint32_t n = cell.first; n < cell.end; ++n) self(self, level - 1, n);
        if (level == 1)
            forParts(cell, [&](glm::ivec3 voxel, float value, double without) {
                if (price < without) out.push_back(kernelOf(shape_, 0, voxel, value));
            });
    };
    for (uint32_t i = 0; i < cells_.back().size(); ++i) take(take, kLevels - 1, i);
    return out;
}

} // namespace brume::volumes

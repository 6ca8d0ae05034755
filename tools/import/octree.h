// Which cells of an octree over the voxels get a Gaussian: where a wide one is good enough, no narrow ones.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/import/mixture.h"
#include "tools/import/voxels.h"

namespace brume::volumes {

// How much the square of an error of a voxel's value counts that is seen along an axis. It depends on what else lies on
// that line.
class ColumnWeights {
public:
    // `per_value`: optical depth of a voxel of value 1.
    ColumnWeights(const Voxels& voxels, double per_value);
    // Outside the medium that of the nearest line.
    double of(int axis, glm::ivec3 voxel) const { return of_[size_t(axis)][index(axis, voxel)]; }

private:
    size_t index(int axis, glm::ivec3 voxel) const {
        const glm::ivec3 at = glm::clamp(voxel - lo_, glm::ivec3(0), size_ - 1);
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        return size_t(at[a]) * size_t(size_[b]) + size_t(at[b]);
    }

    glm::ivec3 lo_, size_;
    std::array<std::vector<double>, 3> of_; // of each axis, by the two coordinates across
};

class Octree {
public:
    // Fits a lattice of one spacing for each level, to know what is left of the voxels there. `voxels` must outlive it.
    Octree(const Voxels& voxels, Shape shape, double per_value, bool ellipsoids);

    // The cells for which squared error + price * number of Gaussians is least. The masses are those of the voxels.
    std::vector<Kernel> choose(double price) const;

private:
    struct Cell {
        uint64_t morton = 0;
        glm::ivec3 at{0};
        uint32_t first = 0, end = 0; // of its parts, among the cells of the level below; of level 1 not used
        float mass = 0;
        float left = 0;    // squared error with a Gaussian of the cell's size
        float without = 0; // and with none
    };

    void makeCells(int level);
    void measure(int level);
    // Calls visit(voxel, its value, squared error without it) for each voxel above 0 in a cell of level 1.
    template <class Visit>
    void forParts(const Cell& cell, const Visit& visit) const;

    const Voxels& voxels_;
    Shape shape_;
    Follow follow_; // of the lattices
    ColumnWeights weights_;
    std::array<std::vector<Cell>, kLevels> cells_; // from level 1 on, by their Morton numbers
};

} // namespace brume::volumes

// A mixture of Gaussians that takes the mass of voxels, fitted by expectation and maximization.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tools/import/voxels.h"

namespace brume::volumes {

inline constexpr int kLevels = 7; // cells of a lattice are 1, 2, 4 ... 64 voxels wide

// Lengths are in voxels. `deviation` is that of what is sampled at the voxels' centres. What lies between them is
// interpolated linearly, which adds kInterpolation to the variance: see trueDeviation().
struct Kernel {
    glm::dvec3 at;
    float deviation;
    float mass; // of voxels' values times their volume
    glm::ivec3 cell;
    int level; // the cell is spacing(level) wide
};
inline constexpr double kInterpolation = 1.0 / 6; // variance of the hat function

struct Shape {
    double ratio = 0.6; // deviation in relation to the width of a cell
    double width = 1;   // of the cells of level 0
    double of(int level) const { return width * double(1 << level); }
};

double trueDeviation(const Kernel& kernel);
// A Gaussian in the middle of a cell.
Kernel kernelOf(const Shape& shape, int level, glm::ivec3 cell, float mass);

class Mixture {
public:
    Mixture(const Voxels& voxels, Shape shape, std::vector<Kernel> kernels);

    // Each round gives every voxel's mass to the Gaussians that cover it, in proportion to what each has there. So the
    // mass of all voxels that are covered stays, and no Gaussian's gets below 0: this is Richardson's and Lucy's rule.
    // `shapes`: places and deviations follow, too, within bounds.
    void refine(int rounds, bool shapes);
    // Leaves out Gaussians without mass, and scales the others so that theirs is that of the voxels.
    void keepMass();

    const std::vector<Kernel>& kernels() const { return kernels_; }
    // What the Gaussians add up to at each of the voxels.
    std::vector<float> sums() const;

private:
    void addUp(std::vector<float>& out) const;
    void order();

    const Voxels& voxels_;
    Shape shape_;
    std::vector<Kernel> kernels_;             // by level, then by their cells' x, y, z
    std::array<size_t, kLevels + 1> begin_{}; // of each level
};

} // namespace brume::volumes

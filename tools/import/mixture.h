// A mixture of Gaussians that takes the mass of voxels, fitted by expectation and maximization.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tools/import/spread.h"
#include "tools/import/voxels.h"

namespace brume::volumes {

inline constexpr int kLevels = 7; // cells of a lattice are 1, 2, 4 ... 64 voxels wide

// Lengths are in voxels. `spread` is that of what is sampled at the voxels' centres. What lies between them is
// interpolated linearly, which adds kInterpolation to the variance along each axis: see trueSpread().
struct Kernel {
    glm::dvec3 at;
    glm::dmat3 spread; // covariance, voxels^2
    float mass;        // of voxels' values times their volume
    glm::ivec3 cell;
    int level; // the cell is spacing(level) wide
};
inline constexpr double kInterpolation = 1.0 / 6; // variance of the hat function

// What follows the mass that a Gaussian gets, besides its own mass.
enum class Follow : uint8_t { nothing, place_and_width, place_and_axes };

struct Shape {
    double ratio = 0.6; // deviation in relation to the width of a cell
    double width = 1;   // of the cells of level 0
    double of(int level) const { return width * double(1 << level); }
};

glm::dmat3 trueSpread(const Kernel& kernel);
bool isBall(const Kernel& kernel);
// A Gaussian in the middle of a cell.
Kernel kernelOf(const Shape& shape, int level, glm::ivec3 cell, float mass);

class Mixture {
public:
    Mixture(const Voxels& voxels, Shape shape, std::vector<Kernel> kernels);

    // Each round gives every voxel's mass to the Gaussians that cover it, in proportion to what each has there. So the
    // mass of all voxels that are covered stays, and no Gaussian's gets below 0: this is Richardson's and Lucy's rule.
    // What else follows stays within bounds of where it began.
    void refine(int rounds, Follow follow);
    // Leaves out Gaussians without mass, and scales the others so that theirs is that of the voxels.
    void keepMass();

    const std::vector<Kernel>& kernels() const { return kernels_; }
    // What the Gaussians add up to at each of the voxels.
    std::vector<float> sums() const;

private:
    template <class Weights>
    void addUp(std::vector<float>& out) const;
    template <class Weights>
    void refineOnce(Follow what);
    void order();

    const Voxels& voxels_;
    Shape shape_;
    std::vector<Kernel> kernels_;             // by level, then by their cells' x, y, z
    std::array<size_t, kLevels + 1> begin_{}; // of each level
    std::vector<float> part_;                 // of a voxel's value in what the Gaussians have there
};

} // namespace brume::volumes

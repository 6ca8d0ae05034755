// Optical depths along many rays through voxels, and how far those of Gaussians are from them. All in double precision.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tools/import/mixture.h"
#include "tools/import/voxels.h"

namespace brume::volumes {

// Relative RMSE over all rays: sqrt(sum (got - true)^2 / sum true^2).
struct SeenError {
    double depth = 0;   // of optical depths
    double opacity = 0; // of 1 - exp(-depth), the light that is stopped
    double picture = 0; // of sunlight that is scattered once towards a viewer: Pictures
    double worst() const { return std::max({depth, opacity, picture}); }
};

class Rays {
public:
    // Along the three axes and in `random` directions besides, `side` x `side` parallel rays each. `per_value`: optical
    // depth of a voxel of value 1. Precondition: some voxel is above 0.
    Rays(const Voxels& voxels, double per_value, int side = 96, int random = 13, uint64_t seed = 1);

    // Without that of pictures.
    SeenError errorOf(std::span<const Kernel> kernels) const;

private:
    struct Bundle {
        glm::dvec3 u, v, toward;
        double u0 = 0, v0 = 0, step = 1; // of the first ray, and between rays
        std::vector<double> depth;       // v slower than u
    };
    std::vector<double> depthsOf(const Bundle& bundle, std::span<const Kernel> kernels) const;

    double per_value_;
    int side_;
    std::vector<Bundle> bundles_;
};

} // namespace brume::volumes

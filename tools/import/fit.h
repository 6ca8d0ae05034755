// The fit of few Gaussians to voxels, within a bound of what is seen.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/import/mixture.h"
#include "tools/import/rays.h"
#include "tools/import/voxels.h"

namespace brume::volumes {

struct FitSettings {
    double error = 0.01;       // allowed: SeenError::worst()
    uint64_t most = 1'000'000; // Gaussians
    double per_value = 1;      // optical depth of a voxel of value 1
    Shape shape{};
    bool ellipsoids = false; // True: Gaussians of three axes; otherwise balls
    int rounds = 24;         // of each fit
};

struct Fit {
    std::vector<Kernel> kernels;
    SeenError error;
    bool kept = false; // True: the error is within the bound
    bool all = false;  // True: `most` allows a Gaussian for each voxel, and the search went as far where it had to
};

// Searches for the price of a Gaussian at which the error is just within the bound. If `most` is too few for that, the
// best fit with so many. The masses add up to that of the voxels. The result is the same however many cores work.
// Precondition: some voxel is above 0.
Fit fit(const Voxels& voxels, const FitSettings& settings);

// A lattice of one spacing with masses alone, for comparison: the widest one within the bound, to a hundredth.
Fit fitLattice(const Voxels& voxels, const FitSettings& settings, double& spacing);

} // namespace brume::volumes

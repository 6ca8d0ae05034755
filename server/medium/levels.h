// Levels of detail of a large medium: its particles sorted in space, and media of fewer, merged particles for distant
// views. Both depend on the particles alone, so that a picture never depends on other viewers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/camera.h"
#include "server/medium/extent.h"
#include "shaders/shared/types.h"

namespace brume {

// Least number of particles that are sorted and merged. With fewer it would cost more than it saves.
inline constexpr uint32_t kLargeMedium = 20'000;

// Most optical depth A of a merged group: the sum of the optical depths through the centres of its particles. A group
// removes between 1 - A/4 and 1 times its cross-section from the light, merged or not and from every side: for sums
// of Gaussians, the integral of tau^2 is at most A/2 times that of tau. So merging changes the removed light by at
// most A/4 = 2.5 %. A particle with a larger depth is never merged.
inline constexpr double kMostMergedDepth = 0.1;

// Sorts particles along a Morton curve, with 512 to 1024 cells across their bounds. Neighbours in space become
// neighbours in memory. Passes that search for the particles of a tile can then skip most others
// (shaders/lib/line_pages.glsl).
class SpatialOrder {
public:
    // Writes the sorted particles to `out`, which has the same size. Stable. Allocates only when there are more
    // particles than before.
    void sort(std::span<const gpu::Particle> particles, std::span<gpu::Particle> out);

    uint64_t bytes() const { return (keys_.capacity() + other_.capacity()) * sizeof(uint64_t); }

private:
    std::vector<uint64_t> keys_, other_; // Morton code << 32 | particle
};

// Merges particles of about the same size that lie in the same cell of side 2^exponent m; cells count from the
// world's origin. Appends the resulting medium to `out`. `ordered`: sorted by SpatialOrder; cells finer than its own
// are merged less completely.
//
// A merged particle keeps the group's integral of extinction over space, the scattered part of it in each colour, the
// centre of mass and the isotropic second moment (variance of the particles + a third of their spread). It loses the
// direction of the spread, detail finer than the cell, and the shadowing within the group, which kMostMergedDepth
// bounds.
//
// Particles are kept unchanged if they are alone in their cell, too thick, or have a standard deviation of four cells
// or more. Precondition: exponent >= -12.
void mergeCells(std::span<const gpu::Particle> ordered, float falloff, int exponent, std::vector<gpu::Particle>& out);

// The exponent of the largest cells that are at most `merge` pixels wide everywhere in the picture. kNoLevel if the
// eye is within the medium's bounds, or if `merge` is 0. Depends on the picture's own camera only.
inline constexpr int kNoLevel = -1000;
int mergeLevel(const Pose& pose, uint32_t width, uint32_t height, const MediumExtent& extent, float merge);

} // namespace brume

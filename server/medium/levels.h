// Level of detail for media of many particles: their order in space, and media of fewer particles that look the same from afar.
// Both are functions of the particles alone, so that a picture never depends on who else is watching.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/camera.h"
#include "server/medium/extent.h"
#include "shaders/shared/types.h"

namespace brume {

// With fewer particles nothing is ordered or merged: it would cost more than it saves.
inline constexpr uint32_t kLargeMedium = 20'000;

// Most optical depth that the lines through the centres of all that is merged into one particle may have together, A. Whatever
// has no more takes between 1 - A/4 and 1 times its cross-section out of the light, from wherever it is seen, before and after:
// for sums of Gaussians the integral of tau^2 is at most A/2 that of tau. So merging changes what a group takes away by 2.5 % at
// most; a particle thicker than that always stays as it is.
inline constexpr double kMostMergedDepth = 0.1;

// The order of particles along a Morton curve through 512 to 1024 cells across their bounds. Neighbours in space become
// neighbours in memory, which lets the passes that look for the particles of a tile skip most others
// (shaders/lib/line_pages.glsl).
class SpatialOrder {
public:
    // `out`: as many. The order of equals is kept. Allocates nothing when there are no more than ever before.
    void sort(std::span<const gpu::Particle> particles, std::span<gpu::Particle> out);

    uint64_t bytes() const { return (keys_.capacity() + other_.capacity()) * sizeof(uint64_t); }

private:
    std::vector<uint64_t> keys_, other_; // Morton code << 32 | particle
};

// Appends to `out` what is left when particles in the same cell of side 2^exponent m (cells count from the world's zero) and of
// about the same size become one. `ordered`: as SpatialOrder leaves them; cells finer than its are merged less completely.
//
// A merged particle has the integral of the extinction over space, what of it is scattered in each colour, the centre of mass and
// the isotropic second moment (their own variance + a third of their spread) of those it stands for. What is lost: the spread's
// direction, everything finer than the cell, and by kMostMergedDepth that they hide each other.
// Stays as it is: what is alone, what is too thick, and what is at least four cells wide in its standard deviation.
// Precondition: exponent >= -12.
void mergeCells(std::span<const gpu::Particle> ordered, float falloff, int exponent, std::vector<gpu::Particle>& out);

// The exponent of the largest cells that are at most `merge` pixels wide wherever the picture shows the medium; kNoLevel when the
// eye is in its bounds or merge is 0. A function of the picture's own camera alone.
inline constexpr int kNoLevel = -1000;
int mergeLevel(const Pose& pose, uint32_t width, uint32_t height, const MediumExtent& extent, float merge);

} // namespace brume

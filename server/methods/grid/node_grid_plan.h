// Where the nodes of method `grid` lie in world space, and what they hold. Interpolation of nodes h apart widens a
// particle: its variance grows by h^2/6 along each axis with linear sampling (a triangle), by h^2/3 with cubic sampling
// (a B-spline). So nodes store each particle narrower by that variance, with equal mass. Sampling then gives the
// particle's own width. The error that is left changes sign within a cell. For a particle of standard deviation s and h
// <= 0.7 s, it is at most (h/s)^2 / 11 of the peak along one axis with linear sampling, and (h/s)^4 / 85 with cubic
// (tests/gpu/grid_test.cpp). A line of sight crosses many cells of many particles, so the error in pictures is far
// smaller. With linear sampling large particles are on coarse nodes first, 2 h apart, and add (2 h/s)^4 / 85.
#pragma once

#include <string>

#include "common/scene.h"
#include "server/medium/extent.h"
#include "shaders/shared/types.h"

namespace brume {

inline constexpr float kGridSpacing = 0.5f; // standard deviations between nodes, where the setting is kAuto
// Below this spacing sampling is cubic, with 64 nodes instead of 8. That is more accurate than linear sampling of nodes
// still closer together.
inline constexpr float kCubicBelow = 0.25f;
// With linear sampling, particles of at least so many spacings are on coarse nodes, twice as far apart: there are an
// eighth as many to add them to. These nodes are coefficients of a cubic B-spline, which the others are taken from.
inline constexpr float kLeastCoarse = 2.3f, kNeverCoarse = 1e30f;

// True: 64 nodes are read for a sample instead of 8.
inline bool isCubic(const RenderSettings& settings) {
    return settings.grid.spacing != kAuto && settings.grid.spacing < kCubicBelow;
}

// Where the nodes lie that the medium asks for, on multiples of the spacing, so that they stay where they are when the
// medium grows.
// linear: true if samples are, however fine the nodes.
gpu::MediumGrid mediumGrid(const MediumExtent& extent, const RenderSettings& settings, bool linear = false);
// The finest grid of at most gpu::kLargestBinding, by steps of a quarter in the spacing.
gpu::MediumGrid gridThatFits(const MediumExtent& extent, const RenderSettings& settings, bool linear = false);
// True: particles that are large enough are on coarse nodes.
inline bool hasCoarse(const gpu::MediumGrid& grid) { return grid.least_coarse < kNeverCoarse; }
// Bricks of coarse nodes (shaders/lib/coarse_nodes.glsl), and the bytes of these.
inline glm::uvec3 coarseBricks(const gpu::MediumGrid& grid) { return grid.bricks / 2u + 1u; }
uint64_t coarseBytes(const gpu::MediumGrid& grid, bool one_albedo);
// Bytes of its nodes: extinction, and with several albedos what scatters each colour.
uint64_t gridBytes(const gpu::MediumGrid& grid, bool one_albedo);
// Empty when that grid may be made; otherwise why not, in one line.
std::string gridRefusal(const MediumExtent& extent, const RenderSettings& settings);

} // namespace brume

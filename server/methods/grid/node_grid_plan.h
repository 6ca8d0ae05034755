// The medium on a grid of nodes in world space: where the nodes lie. Interpolation of nodes h apart is a convolution: with a
// triangle of variance h^2/6 along each axis where it is linear, with a B-spline of h^2/3 where it is cubic. So the nodes hold
// every particle narrower by that, its optical mass kept, and what is sampled is the particle again. The error that is left
// changes sign within a cell: of the peak of a particle of standard deviation s, along one axis, it is at most (h/s)^2 / 11 where
// sampling is linear, (h/s)^4 / 85 where it is cubic, for h <= 0.7 s (tests/gpu/grid_test.cpp). A line of sight crosses many
// cells of many particles: in pictures the error is far smaller.
#pragma once

#include <string>

#include "common/scene.h"
#include "server/medium/extent.h"
#include "shaders/shared/types.h"

namespace brume {

inline constexpr float kGridSpacing = 0.5f; // standard deviations between nodes, where settings.grid is 0
// Grids that are finer are sampled with 64 nodes instead of 8: that is worth more than nodes still closer together.
inline constexpr float kCubicBelow = 0.25f;
inline constexpr uint64_t kMostGridBytes = 96ull << 20; // of the nodes' buffer: every device can bind 128 MiB

// True: 64 nodes are read for a sample instead of 8.
inline bool isCubic(const RenderSettings& settings) { return settings.grid > 0 && settings.grid < kCubicBelow; }

// Where the nodes lie that the medium asks for, on multiples of the spacing, so that they rest when the medium grows.
gpu::MediumGrid mediumGrid(const MediumExtent& extent, const RenderSettings& settings);
// The finest grid of at most kMostGridBytes, by steps of a quarter in the spacing.
gpu::MediumGrid gridThatFits(const MediumExtent& extent, const RenderSettings& settings);
// Bytes of its nodes: extinction, and with several albedos what scatters each colour.
uint64_t gridBytes(const gpu::MediumGrid& grid, bool one_albedo);
// Empty when that grid may be made; otherwise why not, in one line.
std::string gridRefusal(const MediumExtent& extent, const RenderSettings& settings);

} // namespace brume

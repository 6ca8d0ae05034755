// The medium on a grid of nodes in world space: what all viewers of a tick share. Interpolation of nodes h apart is a
// convolution: with a triangle of variance h^2/6 along each axis where it is linear, with a B-spline of h^2/3 where it is cubic.
// So the nodes hold every particle narrower by that, its optical mass kept, and what is sampled is the particle again. What is
// left changes sign within a cell: of the peak of a particle of standard deviation s, along one axis, (h/s)^2 / 11 at most where
// it is linear, (h/s)^4 / 85 where it is cubic, for h <= 0.7 s (tests/gpu/grid_test.cpp). A line of sight crosses many cells of
// many particles: of pictures it is far less.
#pragma once

#include <optional>
#include <string>

#include "common/scene.h"
#include "server/gpu/commands.h"
#include "server/gpu/program.h"
#include "server/light/medium_extent.h"
#include "shaders/shared/types.h"

namespace brume {

inline constexpr float kGridSpacing = 0.5f; // standard deviations between nodes, where settings.grid is 0
// Grids that are finer are sampled with 64 nodes instead of 8: that is worth more than nodes still closer together.
inline constexpr float kCubicBelow = 0.25f;
inline constexpr uint64_t kMostGridBytes = 96ull << 20; // of the nodes' buffer: every device can bind 128 MiB

inline bool isCubic(const RenderSettings& settings) { return settings.grid > 0 && settings.grid < kCubicBelow; }
// Where the nodes lie that the medium asks for, on multiples of the spacing, so that they rest when the medium grows.
gpu::MediumGrid mediumGrid(const MediumExtent& extent, const RenderSettings& settings);
// Of its nodes: extinction, and with several albedos what scatters each colour.
uint64_t gridBytes(const gpu::MediumGrid& grid, bool one_albedo);
// Empty when that grid may be made; else why not, in one line.
std::string gridRefusal(const MediumExtent& extent, const RenderSettings& settings);

class GridPass {
public:
    explicit GridPass(const gpu::Device& device);

    struct Inputs {
        gpu::Resource tick; // binding 0
        const gpu::Buffer* particles;
        uint64_t version; // of the particles and all that the tick says of them
        uint32_t count;   // > 0
        const MediumExtent* extent;
        const RenderSettings* settings;
    };
    // Records the grid, unless it is that of the last time. A grid that is refused is made so coarse that it fits: nothing fails
    // on the way. Precondition: the buffers may be replaced, nothing of theirs is on the device. Ends with its writes visible to
    // compute.
    void record(gpu::Commands& commands, const Inputs& inputs);

    const gpu::MediumGrid& grid() const { return grid_; }
    const gpu::Buffer& nodes() const { return nodes_; } // [what][plane][row][node]; where nobody reads: anything
    const gpu::Buffer& marks() const { return marks_; } // shaders/lib/grid_marks.glsl

private:
    const gpu::Device& device_;
    gpu::ComputeProgram bins_program_, fill_program_;
    gpu::Buffer members_, bins_, nodes_, marks_;
    gpu::MediumGrid grid_{};
    std::optional<uint64_t> version_;
    bool one_albedo_ = true;
};

} // namespace brume

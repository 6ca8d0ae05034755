// ShadowFrusta: which of the shadow grid's lights reach coarse froxels before each eye past opaque objects.
#pragma once

#include <span>
#include <vector>

#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "server/inputs/tick_inputs.h"
#include "server/methods/froxels/shadow_grid.h"
#include "shaders/shared/shadow_frustum.h"

namespace brume {

// Where slices lie: the middle of slice s at the view depth near + unit * (exp2(growth * (s + 0.5)) - 1), in m.
struct ShadowSlices {
    uint32_t count = 0;
    float near = 0, unit = 1, growth = 1;
};

class ShadowFrusta {
public:
    // Width of a froxel, in pixels. docs/results/seed-002.md measures this one.
    static constexpr uint32_t kPixels = 16;

    explicit ShadowFrusta(const gpu::Device& device);

    // Makes the froxels of all eyes, by one ray to each light, unless eyes, lights and objects are those of the last
    // call. 2 MiB for an eye at most, 96 MiB for all. Eyes that need more get fewer slices. Slices of each eye:
    // `slices` has one for all, or as many as there are eyes. Preconditions: the grid has recorded this tick's lights;
    // nothing of the frusta is on the device. Ends with its writes visible to all.
    void record(gpu::Commands& commands, const gpu::Resources& tick_resources, const TickInputs& shared,
                const ShadowGrid& grid, std::span<const gpu::Eye> eyes, std::span<const ShadowSlices> slices);

    // For lib/shadow_frustum.glsl.
    const gpu::Buffer& frusta() const { return frusta_; }   // gpu::ShadowFrustum[]: one for each eye
    const gpu::Buffer& froxels() const { return froxels_; } // uint[]: four froxels each
    // Froxels of all eyes. Those that do not begin in solids have a ray to each light.
    uint64_t count() const { return count_; }
    // Shadow rays of submissions that are done, since the last call of this.
    uint32_t raysSince() { return rays_.since(0); }

private:
    const gpu::Device& device_;
    gpu::Buffer frusta_, froxels_;
    uint64_t count_ = 0;
    gpu::Counts rays_;
    gpu::Variants program_;
    // What the froxels are made of, and what they shall be made of.
    std::vector<gpu::ShadowFrustum> made_, wanted_;
    uint64_t grid_ = 0;
};

} // namespace brume

// LitGrid: the light that arrives at nodes of world space, once a tick for all viewers (shaders/shared/lit_grid.h).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "server/inputs/eye_inputs.h"
#include "server/methods/grid/medium_grid.h"
#include "shaders/shared/lit_grid.h"

namespace brume {

// Where the nodes lie: `spacing` m apart; kAuto: those of the medium where there are only particles; else in the box of
// the particles, or with fog of worldBox(). They are as much farther apart as they must be to fit gpu::kLargestBinding,
// also with `node_bytes` each. No bricks where that box holds nothing. keeps: LitGridShape::keeps.
gpu::LitGridShape litShape(const TickInputs& tick, const MediumView& medium, const gpu::MediumGrid& nodes,
                           float spacing, uint32_t keeps, uint64_t node_bytes = 0);

// What the light at nodes was made of: it is kept while all of that is the same.
class LitKey {
public:
    // Notes what the light is made of now. True: it is what it was at the last call.
    bool isSame(const TickInputs& tick, const MediumView& medium, const gpu::LitGridShape& shape);

private:
    std::optional<uint64_t> medium_, objects_;
    gpu::LitGridShape shape_{};
    gpu::Tick tick_{};
    std::vector<gpu::LocalLight> lights_;
    std::array<float, 1 + gpu::kMostFogs> hue_{};
};

// The light at nodes: what lit_rays.comp reads.
struct LitNodes {
    gpu::Buffer nodes; // float[plane][row][node][number]; nothing without local lights
    gpu::Buffer sun;   // float[plane][row][node]

    void atLeast(const gpu::Device& device, const gpu::LitGridShape& shape);
};
uint64_t nodesOf(const gpu::LitGridShape& shape);

class LitGrid {
public:
    explicit LitGrid(const gpu::Device& device);

    // Records the nodes, unless medium, lights, objects and shape are those of the last call. Preconditions: `nodes` is
    // recorded, and nothing of this is on the device. Ends with its writes visible to compute.
    void record(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium, const GridPass& nodes);

    const gpu::LitGridShape& shape() const { return shape_; }
    const LitNodes& light() const { return light_; }

private:
    const gpu::Device& device_;
    gpu::Variants program_;
    LitNodes light_;
    gpu::LitGridShape shape_{};
    LitKey key_;
};

} // namespace brume

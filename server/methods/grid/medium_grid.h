// Makes the grid of nodes (node_grid_plan.h) on the device, once a tick for all viewers.
#pragma once

#include <optional>

#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "server/inputs/medium_view.h"
#include "server/inputs/volume_buffers.h"
#include "server/methods/grid/node_grid_plan.h"

namespace brume {

class GridPass {
public:
    // `ellipsoids`: SceneFeatures::ellipsoids.
    GridPass(const gpu::Device& device, bool ellipsoids);

    // Records the grid, unless medium.version and the grid's shape are those of the last call. A grid that is refused
    // is made so coarse that it fits: no frame fails for it. Preconditions: there are particles; nothing of the grid's
    // is on the device, its buffers may be replaced. `linear`: as for mediumGrid(). Ends with its writes visible to
    // compute.
    void record(gpu::Commands& commands, const MediumView& medium, const RenderSettings& settings, bool linear = false);

    // Of a volume all three are its own.
    const gpu::MediumGrid& grid() const { return grid_; }
    // float[quantity of the medium][plane][row][node] (shaders/shared/field.h). Bricks without a mark for reading are
    // undefined.
    const gpu::Buffer& nodes() const { return volume_ ? volume_->nodes() : nodes_; }
    const gpu::Buffer& marks() const { return volume_ ? volume_->marks() : marks_; } // shaders/lib/grid_marks.glsl

private:
    const gpu::Program& coarseProgram();              // fills coarse nodes
    const gpu::Program& fineProgram(bool has_coarse); // fills the others. has_coarse: true if there are coarse nodes

    const gpu::Device& device_;
    const bool ellipsoids_;
    gpu::ComputeProgram bins_program_;
    gpu::Variants program_;
    gpu::Buffer members_, skews_, bins_, nodes_, coarse_nodes_, marks_;
    gpu::MediumGrid grid_{};
    const VolumeBuffers* volume_ = nullptr; // MediumView::volume
    std::optional<uint64_t> version_;       // of the particles that the nodes hold
    bool one_albedo_ = true;
};

} // namespace brume

// LitRays: base of methods that keep light at nodes of world space for all viewers, and read it along an eye's rays.
#pragma once

#include <array>

#include "server/gpu/variants.h"
#include "server/methods/froxels/froxel_volume.h"
#include "server/methods/lit/lit_grid.h"

namespace brume {

class LitRays : public FroxelVolume {
public:
    explicit LitRays(const MethodContext& context);

    void recordTick(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium) override;

protected:
    struct Light {
        const gpu::LitGridShape& shape;
        const LitNodes& light;
    };
    // Records the light at nodes for TickInputs::hue, unless it is there already. `nodes`: the medium's. Ends with its
    // writes visible to compute.
    virtual Light recordLight(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium,
                              const GridPass& nodes) = 0;

private:
    void recordRays(gpu::Commands& commands, const EyeInputs& in, const gpu::FroxelGrid& froxels) override;

    GridPass nodes_;
    gpu::Variants program_;
};

// A method whose light is that of a grid of class Grid, which has record(), shape() and light() as LitGrid.
template <class Grid>
class LitBy : public LitRays {
public:
    explicit LitBy(const MethodContext& context)
        : LitRays(context), grids_{Grid(context.device), Grid(context.device), Grid(context.device)} {}

protected:
    std::array<Grid, 3> grids_; // of each hue: light is dimmed as its extinction is

private:
    Light recordLight(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium,
                      const GridPass& nodes) override {
        Grid& grid = grids_[tick.hue];
        grid.record(commands, tick, medium, nodes);
        return {grid.shape(), grid.light()};
    }
};

} // namespace brume

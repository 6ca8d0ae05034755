// RadianceGrid: the light at nodes of world space, as LitGrid has it, but computed at few places and interpolated (Ren,
// Zhou, Lin, Guo, Gradient-based Interpolation and Sampling for Real-time Rendering of Inhomogeneous, Single-scattering
// Media, 2008; docs/models.md).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/gpu/counts.h"
#include "server/gpu/variants.h"
#include "server/methods/lit/lit_grid.h"
#include "shaders/shared/radiance.h"

namespace brume {

class RadianceGrid {
public:
    explicit RadianceGrid(const gpu::Device& device);

    // Notes where viewers are. With RadianceSettings::criterion `printed` samples follow them, the first 4096.
    void follow(std::span<const EyeInputs> eyes);
    // As LitGrid::record().
    void record(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium, const GridPass& nodes);

    const gpu::LitGridShape& shape() const { return shape_; }
    const LitNodes& light() const { return light_; }
    // By gpu::kPlacesLit and so on, of submissions that are done, since the last call of this.
    std::array<uint32_t, gpu::kLightCounts> countsSince();

private:
    const gpu::Device& device_;
    gpu::Variants samples_program_, nested_program_, nodes_program_;
    LitNodes light_;
    gpu::Buffer samples_, states_, spheres_, values_, through_, places_;
    std::vector<glm::vec4> viewers_, seen_by_; // places of this submission, and those that the light was made for
    gpu::Counts counts_;
    gpu::LitGridShape shape_{};
    RadianceSettings settings_;
    LitKey key_;
};

} // namespace brume

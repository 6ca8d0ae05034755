// Propagation: light of the sun that scatters more than once, once per tick and hue for all viewers. Six fluxes pass
// cells of the bounds of the volumetric shadow map (shaders/shared/multiple.h), on three grids: what a coarse one has
// is where the next finer one begins. Each tick begins with no light, so that a picture depends on nothing before it.
// What planes, boxes and spheres reflect of the sun's light is light of the cells, too.
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "server/inputs/medium_view.h"
#include "server/inputs/tick_inputs.h"

namespace brume {

class Propagation {
public:
    explicit Propagation(const gpu::Device& device);

    // Records the fluence of the medium whose depths are in shadow_volume, with the extinction of the TickBlock of
    // `all`, unless the image holds it already: the hue, objects and settings are compared here. Precondition:
    // tick.tick->multiple.cells > 0.
    void record(gpu::Commands& commands, const TickInputs& tick, const MediumView& all);
    // The depths are others from now on.
    void invalidate() { valid_ = false; }
    const gpu::Image& image() const { return image_; } // RGBA32F array: net flux and fluence, [channel][z]
    // Frees its memory. Precondition: nothing of it is on the device.
    void giveBack() { valid_ = false, cells_ = {}, fluxes_ = {}, fluence_ = {}, surfaces_ = {}, image_ = {}; }

private:
    void fit(gpu::Commands& commands, uint32_t side, uint32_t layers);

    const gpu::Device& device_;
    gpu::Variants first_, coarser_, finer_, pass_, of_surfaces_, lit_;
    gpu::Buffer cells_, fluxes_, fluence_, surfaces_;
    gpu::Image image_;
    // What the image depends on besides the depths.
    struct Key {
        gpu::Tick tick{};
        PropagationSettings propagation;
        uint64_t objects = 0;
        SceneFeatures features;
        std::array<float, 1 + gpu::kMostFogs> hue_parts{};
        bool operator==(const Key& other) const;
    };
    Key key_;
    bool valid_ = false; // True: the image is that of the key and of the depths
};

} // namespace brume

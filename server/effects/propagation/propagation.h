// Propagation: light of the sun that scatters more than once, once per tick and hue for all viewers. Six fluxes pass
// cells of the bounds of the volumetric shadow map (shaders/shared/multiple.h), on three grids: what a coarse one has
// is where the next finer one begins. Each tick begins with no light, so that a picture depends on nothing before it.
// What planes, boxes and spheres reflect of the sun's light is light of the cells, too. With own light
// all is absolute (gpu::Multiple::own): the sky's enters at their outer faces, and particles emit some.
#pragma once

#include "server/effects/made_for.h"
#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "server/inputs/medium_view.h"
#include "server/inputs/tick_inputs.h"

namespace brume {

class Propagation {
public:
    explicit Propagation(const gpu::Device& device);

    // Records the fluence of the medium whose depths are in shadow_volume, with the extinction of the TickBlock of
    // `all`, unless the image holds it already. `matter`: CellMatter of every cell; null: all are alike, and emit
    // nothing. Precondition: tick.tick->multiple.cells > 0.
    void record(gpu::Commands& commands, const TickInputs& tick, const MediumView& all, const gpu::Buffer* matter);
    const gpu::Image& image() const { return image_; } // RGBA32F array: net flux and fluence, [channel][z]
    // The same of the light that surfaces around the medium get, where lightsSurfaces(): lib/medium_glow.glsl.
    const gpu::Image& glow() const { return glow_image_; }
    // Frees its memory. Precondition: nothing of it is on the device.
    void giveBack() {
        made_for_.forget(), cells_ = {}, fluxes_ = {}, fluence_ = {}, surfaces_ = {}, lamps_ = {}, direct_ = {},
                            glow_ = {};
        image_ = {}, glow_image_ = {};
    }

private:
    void makeImage(gpu::Commands& commands, gpu::Image& image, uint32_t side, uint32_t layers, const char* name);

    const gpu::Device& device_;
    gpu::Variants first_, coarser_, finer_, pass_, of_surfaces_, lit_, to_lamps_, to_glow_;
    gpu::Buffer cells_, fluxes_, fluence_, surfaces_, lamps_, direct_, glow_;
    gpu::Image image_, glow_image_;
    struct Key {
        gpu::Tick tick{}; // without what the fluxes do not depend on
        PropagationSettings propagation;
        Versions versions; // without that of the particles, whose depths have one
        SceneFeatures features;
        bool operator==(const Key& other) const;
    };
    MadeFor<Key> made_for_;
};

} // namespace brume

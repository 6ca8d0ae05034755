#include "server/effects/propagation/propagation.h"

#include <algorithm>
#include <span>

#include "server/effects/propagation/flux_sizes.h"
#include "server/inputs/constants.h"
#include "server/inputs/multiple_block.h"
#include "shaders/flux_cells_comp.h"
#include "shaders/flux_coarser_comp.h"
#include "shaders/flux_finer_comp.h"
#include "shaders/flux_glow_comp.h"
#include "shaders/flux_lamps_comp.h"
#include "shaders/flux_lit_comp.h"
#include "shaders/flux_pass_comp.h"
#include "shaders/flux_surfaces_comp.h"
#include "shaders/shared/glow.h"
#include "shaders/shared/multiple.h"

namespace brume {

using gpu::storageBuffer;

namespace {

constexpr uint32_t kLanes = 64, kPassLanes = 256;
constexpr uint32_t kFewCells = 2048; // of a grid: one workgroup makes all of its steps

struct Push { // as in the shaders
    uint32_t side, first, all, channels, parity, half_steps, last, surfaces, parts;
};

uint32_t cellsOf(uint32_t side) { return side * side * side; }

// The tick without what the fluxes do not depend on: gpu::Multiple has the irradiance and the sky that they have.
gpu::Tick unlit(gpu::Tick tick) {
    tick.sun.irradiance = tick.ambient = tick.sky_zenith = tick.sky_horizon = glm::vec3(0);
    tick.multiple.irradiance = glm::vec3(0);
    tick.haze = 0;
    tick.local_light_count = 0;
    for (gpu::Fog& fog : tick.fogs) fog.emission = glm::vec3(0);
    return tick;
}

} // namespace

Propagation::Propagation(const gpu::Device& device)
    : device_(device), first_(device, flux_cells_comp, "flux_cells"),
      coarser_(device, flux_coarser_comp, "flux_coarser"), finer_(device, flux_finer_comp, "flux_finer"),
      pass_(device, flux_pass_comp, "flux_pass"), of_surfaces_(device, flux_surfaces_comp, "flux_surfaces"),
      lit_(device, flux_lit_comp, "flux_lit"), to_lamps_(device, flux_lamps_comp, "flux_lamps"),
      to_glow_(device, flux_glow_comp, "flux_glow") {}

void Propagation::makeImage(gpu::Commands& commands, gpu::Image& image, uint32_t side, uint32_t layers,
                            const char* name) {
    if (image && image.extent().width == side && image.layers() == layers) return;
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    image = gpu::Image(device_, {VK_FORMAT_R32G32B32A32_SFLOAT, {side, side}, usage, layers}, name);
    gpu::toGeneral(commands.handle(), image);
}

bool Propagation::Key::operator==(const Key& other) const {
    return std::ranges::equal(std::as_bytes(std::span(&tick, 1)), std::as_bytes(std::span(&other.tick, 1))) &&
           propagation == other.propagation && versions == other.versions && features == other.features;
}

void Propagation::record(gpu::Commands& commands, const TickInputs& tick, const MediumView& all,
                         const gpu::Buffer* matter) {
    const gpu::Multiple& multiple = tick.tick->multiple;
    const PropagationSettings& settings = tick.settings->propagation;
    Key key{unlit(*tick.tick), settings, versionsOf(tick, all), tick.features};
    key.versions.medium = 0;
    if (!made_for_.outdated(key)) return;
    const bool surfaces = reflects(settings) && (tick.tick->plane_count > 0 || tick.reflecting_count > 0);
    gpu::Constants constants = constantsOf(tick.features);
    constants.push_back({gpu::kIdOwnLight, multiple.own});
    constants.push_back({gpu::kIdCellMatter, matter != nullptr});
    const gpu::Commands::Pass timed(commands, "propagation");
    const VkCommandBuffer cmd = commands.handle();
    const uint32_t channels = multiple.channels, side = multiple.cells;
    const bool onto_surfaces = lightsSurfaces(*tick.tick, settings);
    makeImage(commands, image_, side, channels * side, "fluence");
    if (onto_surfaces) makeImage(commands, glow_image_, gpu::kGlowSide, channels * gpu::kGlowSide, "glow");
    uint32_t count = 0; // of the cells of all grids
    for (uint32_t level = 0; level < gpu::kFluxLevels; ++level) count += cellsOf(side >> level);
    const auto make = [&](gpu::Buffer& buffer, VkDeviceSize bytes, VkBufferUsageFlags usage, const char* name) {
        buffer.atLeast(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | usage, gpu::Memory::device, name);
    };
    const FluxSizes sizes = fluxSizes(side, channels, matter != nullptr, onto_surfaces);
    make(cells_, sizes.cells, 0, "cells of fluxes");
    make(fluxes_, sizes.fluxes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, "fluxes");
    make(fluence_, sizes.fluence, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, "fluence of cells");
    if (surfaces) make(surfaces_, sizes.surfaces, 0, "light of surfaces");
    if (onto_surfaces) {
        make(lamps_, sizes.lamps, 0, "lamps of the medium");
        make(direct_, sizes.direct, VK_BUFFER_USAGE_TRANSFER_DST_BIT, "direct light of surfaces");
        make(glow_, sizes.glow, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, "glow of the medium");
    }

    gpu::everythingBefore(cmd); // the last tick's viewers have read it
    vkCmdFillBuffer(cmd, fluxes_.handle(), 0, VK_WHOLE_SIZE, 0);
    gpu::transferToCompute(cmd);
    gpu::Resources resources(&all.resources);
    resources.give(storageBuffer("Cells", cells_));
    resources.give(storageBuffer("FluxesBlock", fluxes_));
    resources.give(storageBuffer("Fluence", fluence_));
    if (surfaces) resources.give(storageBuffer("Surfaces", surfaces_));
    resources.give(storageBuffer("Matter", matter ? *matter : fluence_)); // without it it is not read
    const auto run = [&](gpu::Variants& program, const Push& push, uint32_t lanes) {
        program.with(constants).bind(commands, resources, {}, push);
        vkCmdDispatch(cmd, gpu::groups(lanes, kLanes), 1, 1);
        gpu::computeToCompute(cmd);
    };
    Push push{side, 0, count, channels, 0, 1, 0, tick.reflecting_count, surfaces ? settings.surface_parts : 0};
    run(first_, push, cellsOf(side));
    const auto next = [&] { push.first += cellsOf(push.side), push.side /= 2; };
    if (surfaces) {
        next();
        run(coarser_, push, cellsOf(push.side));
        run(of_surfaces_, push, cellsOf(push.side));
        push.side = side, push.first = 0;
        run(lit_, push, cellsOf(side));
        if (onto_surfaces) {
            gpu::computeToTransfer(cmd);
            const VkBufferCopy all_of_it{.size = sizes.fluence};
            vkCmdCopyBuffer(cmd, fluence_.handle(), direct_.handle(), 1, &all_of_it);
            gpu::everythingBefore(cmd);
        }
    }
    for (uint32_t level = 1; level < gpu::kFluxLevels; ++level) {
        next();
        run(coarser_, push, cellsOf(push.side));
    }
    const gpu::Program& pass = pass_.with(constants);
    for (uint32_t level = gpu::kFluxLevels; level-- > 0;) {
        if (level + 1 < gpu::kFluxLevels) {
            push.side *= 2, push.first -= cellsOf(push.side);
            run(finer_, push, cellsOf(push.side));
        }
        const uint32_t half_steps = 2 * settings.iterations << level;
        const bool few = level > 0 && cellsOf(push.side) <= kFewCells;
        push.half_steps = few ? half_steps : 1;
        for (uint32_t i = 0; i < half_steps; i += push.half_steps) {
            push.parity = i & 1;
            push.last = level == 0 && i + 2 >= half_steps;
            pass.bind(commands, resources, {}, push);
            vkCmdDispatch(cmd, few ? 1 : gpu::groups(cellsOf(push.side) / 2, kPassLanes), 1, 1);
            gpu::computeToCompute(cmd);
        }
    }
    if (onto_surfaces) {
        resources.give(storageBuffer("Lamps", lamps_));
        resources.give(storageBuffer("Direct", direct_));
        resources.give(storageBuffer("Glow", glow_));
        run(to_lamps_, push, gpu::kLamps * kLanes);
        run(to_glow_, push, cellsOf(gpu::kGlowSide));
    }
    gpu::computeToTransfer(cmd);
    const auto copy = [&](const gpu::Buffer& from, const gpu::Image& to) {
        VkBufferImageCopy whole{};
        whole.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, to.layers()};
        whole.imageExtent = {to.extent().width, to.extent().height, 1};
        vkCmdCopyBufferToImage(cmd, from.handle(), to.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &whole);
    };
    copy(fluence_, image_);
    if (onto_surfaces) copy(glow_, glow_image_);
    gpu::everythingBefore(cmd);
}

} // namespace brume

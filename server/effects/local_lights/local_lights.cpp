// Effect `local_lights`: what points and spots add. Per tick, the particles' depth toward each light. Per eye, bins of
// lights for pixels, which the surfaces' shading reads as well. Per group, the light that the medium scatters toward
// the eye, which is composed with the medium's field.
#include <algorithm>

#include "server/effects/effect.h"
#include "server/effects/local_lights/local_lights_plan.h"
#include "server/effects/made_for.h"
#include "server/gpu/binding_sizes.h"
#include "server/inputs/constants.h"
#include "server/inputs/local_light_block.h"
#include "server/inputs/volume_buffers.h"
#include "server/medium/band_limit.h"
#include "shaders/local_light_bins_comp.h"
#include "shaders/local_light_comp.h"
#include "shaders/local_light_depth_comp.h"
#include "shaders/volume_light_depth_comp.h"

namespace brume::effects::local_lights {
namespace {

uint32_t binsOf(uint32_t width, uint32_t height) {
    return gpu::groups(width, gpu::kPixelTile) * gpu::groups(height, gpu::kPixelTile);
}

class LocalLights final : public Effect {
public:
    explicit LocalLights(const gpu::Device& device)
        : device_(device), depths_program_(device, local_light_depth_comp, "local_light_depth"),
          of_volume_(device, volume_light_depth_comp, "volume_light_depth"),
          bins_program_(device, local_light_bins_comp, "local_light_bins"),
          program_(device, local_light_comp, "local_light") {}

    void prepare(const EffectInputs& in, TickInputs& tick) override {
        const uint32_t volumes = makeBlocks(in, *tick.tick);
        setSmoothLengths(blocks_, in.particles, in.extent, tick.tick->falloff, tick.features, in.now.lists.planes);
        tick.lights = blocks_;
        lights_.atLeast(device_, std::max<size_t>(blocks_.size(), 1) * sizeof(gpu::LocalLight),
                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload, "local lights");
        std::ranges::copy(blocks_, lights_.mapped<gpu::LocalLight>(blocks_.size()).begin());
        lights_.flush();

        uint64_t pixels = 0, bins = 0;
        if (tick.features.local_lights) {
            pixels = mostPixels(in.eyes);
            for (const EyeRequest& eye : in.eyes) bins = std::max<uint64_t>(bins, binsOf(eye.width, eye.height));
        }
        grow(bits_, bins * gpu::groups(uint32_t(blocks_.size()), 32) * sizeof(uint32_t), "local light bins");
        grow(lit_, pixels * kLitBytesOfPixel, "local light");
        const VkDeviceSize before = depths_.size();
        grow(depths_, volumes * sizeof(float), "local light depths");
        if (depths_.size() != before) depths_made_for_.forget();
        tick.resources.give(gpu::storageBuffer("LocalLights", lights_));
        tick.resources.give(gpu::storageBuffer("LightBits", bits_));
        tick.resources.give(gpu::storageBuffer("LightDepths", depths_));
        tick.resources.give(gpu::storageBuffer("LitByLocalLights", lit_));
    }

    // The particles' depths toward the lights.
    void recordTick(gpu::Commands& commands, const EffectInputs& in, TickInputs& tick) override {
        const auto has_volume = [](const gpu::LocalLight& light) { return light.volume != gpu::kNoVolume; };
        if (std::ranges::none_of(blocks_, has_volume)) return;
        if (!depths_made_for_.outdated({in.all.version, blocks_})) return;
        const gpu::Commands::Pass pass(commands, "local light depth");
        gpu::everythingBefore(commands.handle());
        if (tick.volume)
            of_volume_.with().bind(
                commands, in.all.resources,
                {gpu::storageBuffer("Nodes", tick.volume->nodes()), gpu::storageBuffer("Marks", tick.volume->marks())},
                tick.volume->grid());
        else
            depths_program_.with({{gpu::kIdEllipsoids, tick.features.ellipsoids}}).bind(commands, in.all.resources, {});
        vkCmdDispatch(commands.handle(), gpu::kMostLightSide / 8, gpu::kMostLightSide / 8, uint32_t(blocks_.size()));
        gpu::everythingBefore(commands.handle());
    }

    void recordEye(gpu::Commands& commands, const EyeInputs& in) override {
        if (!in.shared->features.local_lights) return;
        const gpu::Commands::Pass pass(commands, "local light bins", in.view);
        gpu::everythingBefore(commands.handle()); // the eye before has read its own
        bins_program_.with().bind(commands, in.resources, {});
        vkCmdDispatch(commands.handle(), gpu::groups(binsOf(in.size.width, in.size.height), 64), 1, 1);
        gpu::everythingBefore(commands.handle());
    }

    void recordField(gpu::Commands& commands, const ViewGroup& group) override {
        const EyeInputs& in = *group.any;
        if (!in.shared->features.local_lights) return;
        const gpu::Commands::Pass pass(commands, "local light", group.view());
        const uint32_t step = pixelStep(in.shared->settings->shading, group.rate, in.medium->count > 0);
        gpu::everythingBefore(commands.handle());
        for (uint32_t i = 0; i < group.count(); ++i) {
            if (raysHoldAll(group.views[i])) {
                vkCmdFillBuffer(commands.handle(), lit_.handle(), 0, lit_.size(), 0);
                continue;
            }
            const gpu::Program& program = program_.with(constantsOf(group), {{gpu::kIdStep, step}});
            program.bind(commands, group.resources, {group.blockOf(i)});
            const gpu::View& view = group.views[i];
            vkCmdDispatch(commands.handle(), gpu::groups(view.eye.size.x, gpu::kPixelTile),
                          gpu::groups(view.end - view.first, gpu::kPixelTile), 1);
        }
        gpu::everythingBefore(commands.handle());
    }

    uint64_t pictureBytes() const override {
        const auto taken = [](const gpu::Buffer& buffer) {
            return buffer.size() > gpu::kLeastBinding ? buffer.size() : 0;
        };
        return taken(bits_) + taken(lit_);
    }
    void giveBack() override { bits_ = {}, depths_ = {}, lit_ = {}; }

private:
    struct Key {
        uint64_t particles = 0;
        std::vector<gpu::LocalLight> lights;
        bool operator==(const Key& o) const {
            return particles == o.particles &&
                   std::ranges::equal(std::as_bytes(std::span(lights)), std::as_bytes(std::span(o.lights)));
        }
    };

    // Returns how many numbers all volumes of the particles' depth have.
    uint32_t makeBlocks(const EffectInputs& in, const gpu::Tick& tick) {
        blocks_.clear();
        uint32_t volumes = 0;
        const uint32_t particles = tick.particle_count;
        const auto shadowing = uint32_t(std::ranges::count_if(in.now.lists.lights, &Light::shadows));
        for (const Light& light : in.now.lists.lights) {
            gpu::LocalLight& block = blocks_.emplace_back(localLightBlock(light));
            if (particles > 0 && light.shadows)
                volumes += setVolume(block, in.extent, particles, shadowing, volumes, hasCoarseVolumes(in.now.render));
        }
        return volumes;
    }
    // True: no pixel has light that its rays do not hold. Shaders round otherwise, so those that are on the edge are
    // left to them.
    bool raysHoldAll(const gpu::View& view) const {
        constexpr float kSurely = 0.999f;
        return std::ranges::all_of(blocks_, [&](const gpu::LocalLight& light) {
            return isHeldByRays(light, view.eye, view.grid, kSurely * view.grid.lamp_spacing);
        });
    }
    void grow(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name) const {
        buffer.atLeast(device_, std::max<VkDeviceSize>(bytes, gpu::kLeastBinding),
                       VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::device,
                       name);
    }

    const gpu::Device& device_;
    gpu::Variants depths_program_, of_volume_, bins_program_, program_;
    std::vector<gpu::LocalLight> blocks_; // all points and spots
    gpu::Buffer lights_;                  // gpu::LocalLight[]: blocks_ on the device
    gpu::Buffer bits_;                    // uint[bins][words] of the last eye: a bit for each light
    gpu::Buffer depths_;                  // float[]: all volumes (LocalLight::volume)
    gpu::Buffer lit_;                     // vec3[rows][columns] of the last eye's pixels, W/(m^2 sr)
    MadeFor<Key> depths_made_for_;
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) { return std::make_unique<LocalLights>(context.device); }

} // namespace brume::effects::local_lights

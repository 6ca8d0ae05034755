#include "server/methods/gradients/radiance_grid.h"

#include <algorithm>
#include <optional>

#include "server/gpu/binding_sizes.h"
#include "server/inputs/constants.h"
#include "server/methods/gradients/light_shaders.h"
#include "shaders/radiance_nested_comp.h"
#include "shaders/radiance_nodes_comp.h"
#include "shaders/radiance_samples_comp.h"

namespace brume {
namespace {

constexpr uint32_t kFirstCells = 16;    // of the first grid that samples are split into, along the longest side
constexpr uint32_t kLanes = 64;         // of a workgroup
constexpr uint32_t kMostGroups = 32768; // of a line of workgroups: every device can dispatch 65,535
constexpr size_t kMostViewers = 4096;   // places of so many fill one update of a buffer, 64 KiB
constexpr VkBufferUsageFlags kScratch = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

float luminance(glm::vec3 colour) { return glm::dot(colour, glm::vec3(0.2126f, 0.7152f, 0.0722f)); }

glm::vec3 sizeOf(const gpu::LitGridShape& shape) {
    return (glm::vec3(shape.bricks * gpu::kSlabTile) - 1.0f) * shape.spacing;
}

// Fluence that errors are measured by: of the sun, and of the others in the middle of the nodes, or a quarter of their
// longest side away. Nothing is in their way.
float fluenceOf(const TickInputs& tick, const gpu::LitGridShape& shape) {
    const glm::vec3 size = sizeOf(shape), middle = shape.origin + 0.5f * size;
    const float least = 0.25f * std::max({size.x, size.y, size.z});
    float sum = luminance(tick.tick->sun.irradiance);
    for (const gpu::LocalLight& light : tick.lights) {
        const float distance = std::max(glm::distance(light.position, middle), least);
        sum += luminance(light.intensity) / (distance * distance);
    }
    return std::max(sum, 1e-20f);
}

uint32_t howOf(const RadianceSettings& settings) {
    return (settings.quantity == "radiance" ? gpu::kRadiance : 0) |
           (settings.weights == "printed" ? gpu::kPrinted : 0) |
           (settings.interpolation == "rbf" ? gpu::kNoPlanes : 0) |
           (settings.criterion == "printed" ? gpu::kShadingError : 0) |
           (lightShaders(settings) == LightShaders::exact ? gpu::kExactly : 0) |
           (lightShaders(settings) == LightShaders::nested ? gpu::kNested : 0);
}

gpu::LightSampling samplingOf(const TickInputs& tick, const MediumView& medium, const gpu::LitGridShape& shape,
                              const gpu::MediumGrid& nodes) {
    const RadianceSettings& settings = tick.settings->radiance;
    gpu::LightSampling sampling{};
    sampling.lit = shape;
    sampling.medium = nodes;
    const glm::vec3 size = sizeOf(shape);
    sampling.cell = std::max({size.x, size.y, size.z}) / float(kFirstCells);
    sampling.cells = glm::max(glm::uvec3(glm::ceil(size / sampling.cell - 1e-3f)), 1u);
    sampling.levels = settings.levels;
    sampling.error = settings.error;
    sampling.step = settings.step * nodes.spacing;
    sampling.scale = fluenceOf(tick, shape);
    sampling.how = howOf(settings);
    // Fog reaches beyond the particles.
    const bool particles =
        settings.firsts == "particles" && medium.count > 0 && medium.count <= settings.samples && !tick.features.fog;
    sampling.firsts = particles ? medium.count : settings.samples;
    if (particles) sampling.how |= gpu::kParticles;
    return sampling;
}

// Samples of a grid.
uint32_t samplesOf(const gpu::LightSampling& sampling, uint32_t level) {
    const glm::uvec3 size = (sampling.cells << level) + 1u;
    return size.x * size.y * size.z;
}

} // namespace

RadianceGrid::RadianceGrid(const gpu::Device& device)
    : device_(device), samples_program_(device, radiance_samples_comp, "radiance_samples"),
      nested_program_(device, radiance_nested_comp, "radiance_nested"),
      nodes_program_(device, radiance_nodes_comp, "radiance_nodes"),
      counts_(device, gpu::kLightCounts, "light counts") {}

std::array<uint32_t, gpu::kLightCounts> RadianceGrid::countsSince() {
    std::array<uint32_t, gpu::kLightCounts> counts{};
    for (uint32_t i = 0; i < gpu::kLightCounts; ++i) counts[i] = counts_.since(i);
    return counts;
}

void RadianceGrid::follow(std::span<const EyeInputs> eyes) {
    viewers_.clear();
    for (const EyeInputs& in : eyes.first(std::min(eyes.size(), kMostViewers)))
        viewers_.emplace_back(in.pose.position, 1);
}

void RadianceGrid::record(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium,
                          const GridPass& nodes) {
    const RadianceSettings& settings = tick.settings->radiance;
    const bool fluence = settings.quantity == "radiance";
    shape_ = litShape(tick, medium, nodes.grid(), settings.spacing, fluence ? gpu::kKeepsFluence : gpu::kKeepsColours,
                      sizeof(glm::vec4));
    const LightShaders shaders = lightShaders(settings);
    const bool nested = shaders == LightShaders::nested, spheres = shaders == LightShaders::spheres;
    const bool followed = spheres && settings.criterion == "printed"; // samples depend on where viewers are
    const bool same = settings == settings_ && (!followed || seen_by_ == viewers_);
    settings_ = settings, seen_by_ = viewers_;
    if (key_.isSame(tick, medium, shape_) && same) return;
    light_.atLeast(device_, shape_);
    if (shape_.bricks.x == 0) return;

    gpu::LightSampling push = samplingOf(tick, medium, shape_, nodes.grid());
    push.viewers = uint32_t(viewers_.size());
    uint64_t samples = push.firsts;
    for (uint32_t level = 0; level < push.levels; ++level) samples += samplesOf(push, level);
    const auto grow = [&](gpu::Buffer& buffer, uint64_t count, size_t each, const char* name) {
        buffer.atLeast(device_, std::max<VkDeviceSize>(count * each, gpu::kLeastBinding), kScratch, gpu::Memory::device,
                       name);
    };
    grow(samples_, spheres ? samples : 0, sizeof(gpu::LightSample), "light samples");
    grow(states_, spheres ? samples : nested ? nodesOf(shape_) : 0, sizeof(uint32_t), "states of light samples");
    grow(spheres_, spheres ? push.firsts : 0, sizeof(glm::vec4), "spheres of light samples");
    grow(through_, followed ? samples : 0, sizeof(uint32_t), "transmittances of light samples");
    grow(places_, followed ? viewers_.size() : 0, sizeof(glm::vec4), "places of viewers");
    grow(values_, nested ? nodesOf(shape_) : 0, sizeof(glm::vec4), "nested light");

    const VkCommandBuffer cmd = commands.handle();
    std::optional<gpu::Commands::Pass> pass(std::in_place, commands, "radiance samples");
    gpu::everythingBefore(cmd); // the eyes before have read it
    if (spheres) vkCmdFillBuffer(cmd, states_.handle(), 0, VK_WHOLE_SIZE, gpu::kNoSample);
    if (followed) {
        vkCmdFillBuffer(cmd, through_.handle(), 0, VK_WHOLE_SIZE, 0);
        if (!viewers_.empty())
            vkCmdUpdateBuffer(cmd, places_.handle(), 0, viewers_.size() * sizeof(glm::vec4), viewers_.data());
    }
    counts_.begin(commands);
    gpu::transferToCompute(cmd);
    gpu::Resources shared(&medium.resources);
    shared.give(gpu::storageBuffer("Nodes", nodes.nodes()));
    shared.give(gpu::storageBuffer("Marks", nodes.marks()));
    shared.give(gpu::storageBuffer("Counts", counts_.buffer()));
    const auto record = [&](gpu::Variants& variants, std::initializer_list<gpu::Resource> own, glm::uvec3 groups) {
        variants.with(constantsOf(tick.features)).bind(commands, shared, own, push);
        vkCmdDispatch(cmd, groups.x, groups.y, groups.z);
        gpu::computeToCompute(cmd);
    };
    const auto inLines = [](uint32_t lanes) {
        const uint32_t all = gpu::groups(lanes, kLanes), line = std::min(all, kMostGroups);
        return glm::uvec3(line, gpu::groups(all, std::max(line, 1u)), 1);
    };
    if (spheres)
        for (push.level = -1; push.level < int(push.levels); ++push.level) {
            const uint32_t lanes = push.level < 0 ? push.firsts : samplesOf(push, uint32_t(push.level));
            record(samples_program_,
                   {gpu::storageBuffer("Samples", samples_), gpu::storageBuffer("States", states_),
                    gpu::storageBuffer("Spheres", spheres_), gpu::storageBuffer("Through", through_),
                    gpu::storageBuffer("Viewers", places_)},
                   inLines(lanes));
        }
    if (nested)
        for (push.level = 1 << push.levels; push.level > 0; push.level /= 2) {
            const glm::uvec3 lanes = shape_.bricks * gpu::kSlabTile / uint32_t(push.level);
            record(nested_program_, {gpu::storageBuffer("Values", values_), gpu::storageBuffer("States", states_)},
                   inLines(lanes.x * lanes.y * lanes.z));
        }
    pass.emplace(commands, "radiance nodes");
    record(nodes_program_,
           {gpu::storageBuffer("LitNodes", light_.nodes), gpu::storageBuffer("SunNodes", light_.sun),
            gpu::storageBuffer("Samples", samples_), gpu::storageBuffer("States", states_),
            gpu::storageBuffer("Spheres", spheres_), gpu::storageBuffer("Values", values_)},
           shape_.bricks);
    counts_.end(commands);
}

} // namespace brume

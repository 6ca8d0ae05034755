#include "server/methods/froxels/shadow_grid.h"

#include <algorithm>
#include <cmath>

#include "server/gpu/binding_sizes.h"
#include "server/inputs/constants.h"
#include "shaders/shadow_grid_comp.h"

namespace brume {
namespace {

constexpr float kAutoVoxels = 200; // along the longest side
constexpr float kWider = 1.26f;    // voxels of a grid that does not fit
constexpr VkBufferUsageFlags kWritten =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
constexpr uint64_t kVoxelsOfBrick = uint64_t(gpu::kShadowBrick) * gpu::kShadowBrick * gpu::kShadowBrick;

uint64_t bricksOf(const gpu::ShadowGridBlock& shape) {
    return uint64_t(shape.bricks.x) * shape.bricks.y * shape.bricks.z;
}

uint64_t bytesOf(const gpu::ShadowGridBlock& shape) { return bricksOf(shape) * kVoxelsOfBrick * shape.stride; }

// The origin is on multiples of a brick, so that bounds that move a little move no voxels.
void place(gpu::ShadowGridBlock& shape, float voxel, glm::vec3 lo, glm::vec3 hi) {
    const float brick = voxel * float(gpu::kShadowBrick);
    const glm::vec3 first = glm::floor(lo / brick), last = glm::max(glm::ceil(hi / brick), first + 1.0f);
    shape.voxel = voxel;
    shape.origin = first * brick;
    shape.bricks = glm::uvec3(glm::min(last - first, glm::vec3(1e4f)));
}

bool sameLights(const gpu::ShadowGridBlock& a, const gpu::ShadowGridBlock& b) {
    return std::ranges::equal(a.lights, b.lights, [](const gpu::ShadowSlot& x, const gpu::ShadowSlot& y) {
        return x.to == y.to && x.local == y.local && x.bound == y.bound && x.reach == y.reach;
    });
}

float strength(const gpu::LocalLight& light) { return light.intensity.x + light.intensity.y + light.intensity.z; }

} // namespace

gpu::ShadowEye shadowEye(const gpu::Eye& eye, float far, float margin) {
    // Tangents of the picture's sides, to the right and up.
    const float wider = margin * 2 * eye.tan_x / float(eye.size.x), higher = margin * 2 * eye.tan_y / float(eye.size.y);
    const float left = glm::dot(eye.right, eye.ray) - wider, top = glm::dot(eye.up, eye.ray) + higher;
    const float right = left + 2 * (eye.tan_x + wider), bottom = top - 2 * (eye.tan_y + higher);
    const auto plane = [&](glm::vec3 normal, float depth) {
        const glm::vec3 unit = glm::normalize(normal);
        return glm::vec4(unit, -glm::dot(unit, eye.position - depth * eye.back));
    };
    return {{plane(-eye.back, eye.near_depth), plane(eye.back, far), plane(eye.right + left * eye.back, 0),
             plane(-eye.right - right * eye.back, 0), plane(eye.up + bottom * eye.back, 0),
             plane(-eye.up - top * eye.back, 0)}};
}

ShadowSlots shadowSlots(const gpu::Tick& tick, std::span<const gpu::LocalLight> lights, const ShadowSlots& before) {
    std::vector<uint32_t> chosen;
    for (uint32_t i = 0; i < lights.size(); ++i)
        if (lights[i].shadows != 0 && strength(lights[i]) > 0) chosen.push_back(i);
    std::ranges::stable_sort(chosen, [&](uint32_t a, uint32_t b) { return strength(lights[a]) > strength(lights[b]); });
    if (tick.sun.irradiance != glm::vec3(0)) chosen.insert(chosen.begin(), ShadowSlots::kSun);
    chosen.resize(std::min<size_t>(chosen.size(), ShadowSlots::kMost));

    ShadowSlots slots = before;
    std::ranges::replace_if(
        slots.lights, [&](uint32_t light) { return std::ranges::find(chosen, light) == chosen.end(); },
        gpu::kNoShadowSlot);
    for (const uint32_t light : chosen) {
        if (std::ranges::find(slots.lights, light) != slots.lights.end()) continue;
        const auto free = std::ranges::find(slots.lights, gpu::kNoShadowSlot);
        if (light == ShadowSlots::kSun)
            slots.lights.insert(slots.lights.begin(), light); // others move: all is made anew
        else if (free != slots.lights.end())
            *free = light;
        else
            slots.lights.push_back(light);
    }
    std::erase(slots.lights, gpu::kNoShadowSlot);
    return slots;
}

gpu::ShadowGridBlock shadowGridShape(const ShadowGridSettings& settings, glm::vec3 lo, glm::vec3 hi, uint32_t slots) {
    gpu::ShadowGridBlock shape{};
    shape.coverage = settings.values == "coverage";
    shape.linear = settings.lookup == "linear";
    shape.stride = shape.coverage ? 4 * gpu::groups(std::max(slots, 1u), 4) : 1;
    shape.slots = slots;
    const glm::vec3 size = glm::max(hi - lo, glm::vec3(1e-3f));
    float voxel = settings.voxel;
    if (voxel == kAuto) { // on a ladder of third octaves
        const float wanted = std::max({size.x, size.y, size.z}) / kAutoVoxels;
        voxel = std::exp2(std::round(3 * std::log2(wanted)) / 3);
    }
    place(shape, voxel, lo, hi);
    while (bytesOf(shape) > gpu::kLargestBinding) place(shape, voxel *= kWider, lo, hi);
    return shape;
}

ShadowGrid::ShadowGrid(const gpu::Device& device)
    : device_(device), rays_(device, 1, "shadow rays"), program_(device, shadow_grid_comp, "shadow_grid") {
    constexpr VkBufferUsageFlags kBlock = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    block_ = gpu::Buffer(device, sizeof(gpu::ShadowGridBlock), kBlock, gpu::Memory::device, "shadow grid");
    eyes_ = gpu::Buffer(device, gpu::kMostShadowEyes * sizeof(gpu::ShadowEye), kWritten, gpu::Memory::device,
                        "shadow grid eyes");
}

// True if voxels that are there may stay until they are replaced.
bool ShadowGrid::fits(const ShadowGridInputs& in, const gpu::ShadowGridBlock& shape, const ShadowSlots& slots) const {
    return version_ > 0 && slots == slots_ && shape.origin == shape_.origin && shape.voxel == shape_.voxel &&
           shape.bricks == shape_.bricks && shape.stride == shape_.stride && shape.coverage == shape_.coverage &&
           in.tick.triangle_count == triangles_;
}

void ShadowGrid::record(gpu::Commands& commands, const ShadowGridInputs& in) {
    const gpu::Commands::Pass pass(commands, "shadow grid");
    const ShadowGridSettings& settings = in.shared.settings->shadow_grid;
    const ShadowSlots slots = shadowSlots(in.tick, in.lights, slots_);
    gpu::ShadowGridBlock shape = shadowGridShape(settings, in.lo, in.hi, uint32_t(slots.lights.size()));
    slot_of_light_.assign(std::max<size_t>(in.lights.size(), 1), gpu::kNoShadowSlot);
    shape.sun = gpu::kNoShadowSlot;
    for (uint32_t s = 0; s < slots.lights.size(); ++s) {
        const uint32_t light = slots.lights[s];
        if (light == ShadowSlots::kSun) {
            shape.sun = s;
            shape.lights[s] = {in.tick.sun.to_light, 0, glm::vec3(0), 1e30f};
        } else {
            slot_of_light_[light] = s;
            shape.lights[s] = {in.lights[light].position, 1, in.lights[light].bound, in.lights[light].reach};
        }
    }
    const bool clear = !fits(in, shape, slots);
    const bool changed = clear || settings.retrace || in.key != key_ || !sameLights(shape, shape_) ||
                         in.tick.opaque_count != objects_ || settings.parity != settings_.parity;
    if (clear)
        version_ = 1;
    else if (changed)
        ++version_;
    if (changed) ++calls_changed_;
    shape_ = shape, slots_ = slots, settings_ = settings, key_ = in.key;
    objects_ = in.tick.opaque_count, triangles_ = in.tick.triangle_count;

    const uint64_t bricks = bricksOf(shape);
    voxels_.atLeast(device_, bytesOf(shape), kWritten, gpu::Memory::device, "shadow voxels");
    states_.atLeast(device_, bricks * sizeof(glm::uvec2), kWritten, gpu::Memory::device, "shadow bricks");
    const VkDeviceSize mask_bytes = shape.coverage != 0 ? 256 : bricks * kVoxelsOfBrick / 8;
    masks_.atLeast(device_, mask_bytes, kWritten, gpu::Memory::device, "shadow voxels made");
    const VkDeviceSize slot_bytes = slot_of_light_.size() * sizeof(uint32_t);
    slots_of_lights_.atLeast(device_, slot_bytes, kWritten, gpu::Memory::device, "shadow slots");

    const VkCommandBuffer cmd = commands.handle();
    gpu::everythingBefore(cmd); // readers of the call before
    if (clear) vkCmdFillBuffer(cmd, states_.handle(), 0, bricks * sizeof(glm::uvec2), 0);
    rays_.begin(commands);
    vkCmdUpdateBuffer(cmd, block_.handle(), 0, sizeof shape, &shape);
    constexpr VkDeviceSize kMostBytes = 65536; // bytes that one update can write
    for (VkDeviceSize at = 0; at < slot_bytes; at += kMostBytes)
        vkCmdUpdateBuffer(cmd, slots_of_lights_.handle(), at, std::min(kMostBytes, slot_bytes - at),
                          slot_of_light_.data() + at / sizeof(uint32_t));
    seen_by_.clear();
    if (in.eyes.size() <= gpu::kMostShadowEyes)
        for (const gpu::Eye& eye : in.eyes) seen_by_.push_back(shadowEye(eye, in.far, in.margin));
    if (!seen_by_.empty())
        vkCmdUpdateBuffer(cmd, eyes_.handle(), 0, seen_by_.size() * sizeof(gpu::ShadowEye), seen_by_.data());
    gpu::everythingBefore(cmd);
    if (!slots.lights.empty() && !in.eyes.empty()) {
        program_.with(constantsOf(in.shared.features))
            .bind(commands, in.resources,
                  {gpu::uniformBuffer("GridBlock", block_, 0, sizeof shape), gpu::storageBuffer("Voxels", voxels_),
                   gpu::storageBuffer("States", states_), gpu::storageBuffer("Masks", masks_),
                   gpu::storageBuffer("Eyes", eyes_), gpu::storageBuffer("Counter", rays_.buffer())},
                  gpu::ShadowGridPush{version_, settings.parity ? layer_ : 2u, uint32_t(in.eyes.size())});
        vkCmdDispatch(cmd, shape.bricks.x, shape.bricks.y, shape.bricks.z);
        layer_ ^= 1u;
    }
    rays_.end(commands);
    gpu::everythingBefore(cmd);
}

} // namespace brume

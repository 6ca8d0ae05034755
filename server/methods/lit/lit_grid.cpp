#include "server/methods/lit/lit_grid.h"

#include <algorithm>
#include <cstring>

#include "server/gpu/binding_sizes.h"
#include "server/inputs/constants.h"
#include "server/inputs/world_box.h"
#include "shaders/lit_grid_comp.h"

namespace brume {
namespace {

constexpr double kNodesAcross = 96; // along the longest side of a box without particles
constexpr double kCoarser = 1.26;

uint32_t numbersOf(uint32_t keeps, size_t lights) {
    if (lights == 0) return 0;
    return keeps == gpu::kKeepsLights ? uint32_t(lights) : keeps == gpu::kKeepsColours ? 3 : 12;
}

gpu::LitGridShape shapeOver(const Bounds3& box, double spacing, uint64_t node_bytes) {
    gpu::LitGridShape shape{};
    for (;; spacing *= kCoarser) {
        const glm::dvec3 first = glm::floor(box.lo / spacing), last = glm::ceil(box.hi / spacing);
        shape.origin = first * spacing;
        shape.spacing = float(spacing);
        shape.bricks = glm::uvec3(glm::ceil(glm::min(last - first + 1.0, glm::dvec3(1e5)) / double(gpu::kSlabTile)));
        if (node_bytes * nodesOf(shape) <= gpu::kLargestBinding) return shape;
    }
}

Bounds3 particlesOf(const MediumView& medium) {
    return medium.count > 0 ? Bounds3{medium.extent->lo, medium.extent->hi} : Bounds3{};
}

bool sameBytes(const void* a, const void* b, size_t size) { return std::memcmp(a, b, size) == 0; }

} // namespace

uint64_t nodesOf(const gpu::LitGridShape& shape) {
    constexpr uint64_t kNodes = uint64_t(gpu::kSlabTile) * gpu::kSlabTile * gpu::kSlabTile;
    return uint64_t(shape.bricks.x) * shape.bricks.y * shape.bricks.z * kNodes;
}

gpu::LitGridShape litShape(const TickInputs& tick, const MediumView& medium, const gpu::MediumGrid& nodes,
                           float spacing, uint32_t keeps, uint64_t node_bytes) {
    const uint32_t numbers = numbersOf(keeps, tick.features.local_lights ? tick.lights.size() : 0);
    node_bytes = std::max<uint64_t>(node_bytes, std::max(numbers, 1u) * sizeof(float));
    const auto kept = [&](gpu::LitGridShape shape) {
        shape.near = tick.settings->radiance.near;
        shape.keeps = keeps;
        shape.numbers = numbers;
        return shape;
    };
    if (!tick.features.fog && spacing == kAuto) {
        const gpu::LitGridShape shape{
            .origin = nodes.origin, .spacing = nodes.spacing, .bricks = nodes.bricks, .particles = 1};
        if (node_bytes * nodesOf(shape) <= gpu::kLargestBinding) return kept(shape);
    }
    // Without fog there is nothing to light beside the particles.
    const Bounds3 box = tick.features.fog ? worldBox(tick, medium) : particlesOf(medium);
    if (!(box.lo.x <= box.hi.x)) return {};
    const glm::dvec3 size = box.hi - box.lo;
    double apart = std::max({size.x, size.y, size.z, 1e-3}) / kNodesAcross;
    if (medium.count > 0) apart = std::min(apart, double(nodes.spacing));
    return kept(shapeOver(box, spacing != kAuto ? double(spacing) : apart, node_bytes));
}

bool LitKey::isSame(const TickInputs& tick, const MediumView& medium, const gpu::LitGridShape& shape) {
    const bool same = medium_ == medium.version && hue_ == tick.hue_parts && objects_ == tick.objects_version &&
                      sameBytes(&shape, &shape_, sizeof shape) && sameBytes(tick.tick, &tick_, sizeof tick_) &&
                      lights_.size() == tick.lights.size() &&
                      (lights_.empty() || sameBytes(lights_.data(), tick.lights.data(), tick.lights.size_bytes()));
    medium_ = medium.version, objects_ = tick.objects_version, shape_ = shape, tick_ = *tick.tick;
    hue_ = tick.hue_parts;
    lights_.assign(tick.lights.begin(), tick.lights.end());
    return same;
}

void LitNodes::atLeast(const gpu::Device& device, const gpu::LitGridShape& shape) {
    const uint64_t count = nodesOf(shape), bytes = count * shape.numbers * sizeof(float);
    nodes.atLeast(device, std::max<uint64_t>(bytes, gpu::kLeastBinding), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                  gpu::Memory::device, "lit nodes");
    sun.atLeast(device, std::max<uint64_t>(count * sizeof(float), gpu::kLeastBinding),
                VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "sunlit nodes");
}

LitGrid::LitGrid(const gpu::Device& device) : device_(device), program_(device, lit_grid_comp, "lit_grid") {}

void LitGrid::record(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium, const GridPass& nodes) {
    const bool lobes = tick.features.lobe || tick.features.fog; // without them directions do not matter
    const bool few = tick.lights.size() <= gpu::kMostKeptLights;
    shape_ = litShape(tick, medium, nodes.grid(), tick.settings->radiance.spacing,
                      lobes && few ? gpu::kKeepsLights : gpu::kKeepsFluence);
    if (key_.isSame(tick, medium, shape_)) return;
    light_.atLeast(device_, shape_);
    if (shape_.bricks.x == 0) return;
    const gpu::Commands::Pass pass(commands, "lit grid");
    const struct {
        gpu::LitGridShape lit;
        gpu::MediumGrid medium;
    } push{shape_, nodes.grid()};
    gpu::everythingBefore(commands.handle()); // the eyes before have read it
    program_.with(constantsOf(tick.features))
        .bind(commands, medium.resources,
              {gpu::storageBuffer("LitNodes", light_.nodes), gpu::storageBuffer("SunNodes", light_.sun),
               gpu::storageBuffer("Marks", nodes.marks())},
              push);
    vkCmdDispatch(commands.handle(), shape_.bricks.x, shape_.bricks.y, shape_.bricks.z);
    gpu::computeToCompute(commands.handle());
}

} // namespace brume

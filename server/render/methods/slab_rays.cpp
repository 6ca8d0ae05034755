#include "server/render/methods/slab_rays.h"

#include <algorithm>
#include <cmath>

#include "shaders/slab_spline_comp.h"

namespace brume {
namespace {

// What follows from the medium's band limit; the errors that they leave are measured by tests/bench/sweeps/methods.toml.
constexpr float kRaysPerDeviation = 0.85f; // spacing of rays in projected standard deviations, at most
constexpr float kSlabsPerDeviation = 0.7f; // thickness of slabs in standard deviations
constexpr uint32_t kRates[] = {16, 12, 8, 6, 4, 2, 1};
constexpr uint32_t kLeastSlabs = 8, kMostSlabs = 256;
constexpr float kNearDepth = 0.05f;
constexpr VkDeviceSize kMostBytes = 96 << 20; // of a buffer: every device can bind 128 MiB
// Nodes before the first pixel's: one that cubic interpolation needs, two that the spline's coefficients need.
constexpr uint32_t kMargin = 3;

// Of a row or column of nodes: those that are not a cell's first.
uint32_t nodesBeyond(const gpu::SlabGrid& grid) { return 2 * grid.margin + 1; }

void coarsen(gpu::SlabGrid& grid) {
    grid.thickness *= 2;
    grid.lines.z = gpu::groups(grid.lines.z, 2);
    grid.slabs = grid.lines.z * grid.sheet;
}

// View depths between which the medium lies.
std::pair<float, float> depths(const EyeInputs& in) {
    const glm::vec3 forward = in.pose.orientation * glm::vec3(0, 0, -1);
    float near = 1e30f, far = -1e30f;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 at(corner & 1 ? in.extent->hi.x : in.extent->lo.x, corner & 2 ? in.extent->hi.y : in.extent->lo.y,
                           corner & 4 ? in.extent->hi.z : in.extent->lo.z);
        const float depth = glm::dot(at - in.pose.position, forward);
        near = std::min(near, depth);
        far = std::max(far, depth);
    }
    return {std::max(near, kNearDepth), far};
}

// Of the whole picture, but for its rows.
gpu::SlabGrid gridOf(const EyeInputs& in) {
    gpu::SlabGrid grid{};
    auto [near, far] = depths(in);
    far = std::max(far, near + 1e-3f); // all of it behind the eye: slabs without particles
    const float pixel = 2 * std::tan(0.5f * in.pose.fov_y) / float(in.size.height); // m per m of view depth
    const float deviation = in.extent->deviation, projected = deviation / (pixel * 0.5f * (near + far));
    grid.rate = in.settings->rate;
    if (grid.rate == 0)
        for (const uint32_t rate : kRates)
            if (grid.rate = rate; float(rate) <= kRaysPerDeviation * projected) break;
    // A row of tiles has bits for all particles.
    while (grid.rate < kRates[0] && gpu::groups(in.size.width, grid.rate * gpu::kSlabTile) * (in.particle_count / 8) > kMostBytes)
        grid.rate *= 2;
    const float wanted = std::ceil((far - near) / (kSlabsPerDeviation * deviation));
    const uint32_t slabs = in.settings->slabs ? in.settings->slabs : uint32_t(std::clamp(wanted, 1.0f, float(kMostSlabs)));
    grid.sheet = 8;
    grid.margin = grid.rate > 1 ? kMargin : 1;
    grid.nodes = {gpu::groups(in.size.width, grid.rate) + nodesBeyond(grid), 0};
    grid.lines = {gpu::groups(grid.nodes.x, gpu::kSlabTile), 0, gpu::groups(std::max(slabs, kLeastSlabs), grid.sheet)};
    grid.slabs = grid.lines.z * grid.sheet;
    grid.depth = near;
    grid.thickness = (far - near) / float(grid.slabs);
    grid.first_caster = in.first_caster;
    grid.albedo = in.extent->albedo;
    return grid;
}

} // namespace

void SlabRays::prepare(std::span<const EyeInputs> eyes) {
    if (eyes.empty() || eyes.front().particle_count == 0) return;
    VkDeviceSize field = 0;
    for (const EyeInputs& in : eyes) {
        const Bands bands = bandsOf(in);
        field = std::max(field, fieldBytes(bands.grid, sources(in)));
        fitBand(in, bands.grid, sources(in));
    }
    fit(field_, field, "slab field");
}

void SlabRays::record(gpu::Commands& commands, const EyeInputs& in) {
    const Bands bands = bandsOf(in);
    gpu::SlabGrid grid = bands.grid;
    gpu::everythingBefore(commands.handle()); // the eye before has used the same buffers
    for (; grid.first_row < bands.cells; grid.first_row += bands.step) {
        recordBand(commands, in, grid, sources(in));
        if (grid.rate > 1) recordSpline(commands, in, grid);
        const MediumField field{&field_, grid, sources(in)};
        const uint32_t first = grid.first_row * grid.rate, end = std::min(first + bands.step * grid.rate, in.size.height);
        in.compose->record(commands, in, first, end - first, &field);
    }
}

void SlabRays::recordSpline(gpu::Commands& commands, const EyeInputs& in, const gpu::SlabGrid& grid) {
    const gpu::Commands::Pass pass(commands, "spline", in.view);
    made(slab_spline_comp, "slab_spline", sources(in), {{0, features_.opaque}, {24, sources(in)}})
        .bind(commands.handle(), {gpu::storageBuffer(2, field_)}, grid);
    vkCmdDispatch(commands.handle(), gpu::groups(grid.nodes.x * grid.nodes.y, 64), 1, 1);
    gpu::computeToCompute(commands.handle());
}

VkDeviceSize SlabRays::fieldBytes(const gpu::SlabGrid& grid, uint32_t sources) const { // lib/slab_field.glsl
    const uint32_t planes = (sources + 1) * (features_.opaque ? grid.slabs + 3 : 2) + 2;
    return VkDeviceSize(grid.nodes.x) * grid.nodes.y * planes * sizeof(float);
}

SlabRays::Bands SlabRays::bandsOf(const EyeInputs& in) const {
    Bands bands{gridOf(in), 0, 0};
    gpu::SlabGrid& grid = bands.grid;
    bands.cells = gpu::groups(in.size.height, grid.rate);
    const auto tooLarge = [&] { return std::max(bandBytes(grid, sources(in)), fieldBytes(grid, sources(in))) > kMostBytes; };
    const auto rowsOfTiles = [&](uint32_t rows) {
        grid.lines.y = rows;
        grid.nodes.y = rows * gpu::kSlabTile;
    };
    const uint32_t beyond = nodesBeyond(grid);
    rowsOfTiles(gpu::groups(bands.cells + beyond, gpu::kSlabTile));
    while (grid.lines.y > 2 && tooLarge()) rowsOfTiles(gpu::groups(grid.lines.y, 2));
    while (tooLarge()) coarsen(grid);
    // The next band has the rows again that lie beyond its cells; even, since compose makes two rows of pixels at a time.
    bands.step = grid.nodes.y < bands.cells + beyond ? (grid.nodes.y - beyond) & ~1u : bands.cells;
    return bands;
}

void SlabRays::fit(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name) const {
    if (!buffer || buffer.size() < bytes)
        buffer = gpu::Buffer(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                             gpu::Memory::device, name);
}

const gpu::ComputeProgram& SlabRays::made(std::span<const uint32_t> code, const char* name, uint32_t variant,
                                          std::initializer_list<gpu::SpecConstant> constants) {
    gpu::ComputeProgram& program = programs_[{code.data(), variant}];
    if (!program) program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, code, name}, constants);
    return program;
}

} // namespace brume

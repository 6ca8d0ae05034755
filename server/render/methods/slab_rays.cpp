#include "server/render/methods/slab_rays.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "server/render/background.h"
#include "server/render/shading.h"
#include "shaders/slab_spline_comp.h"

namespace brume {
namespace {

// What else follows from the medium's band limit (shading.h); the errors that they leave are measured by
// tests/bench/sweeps/methods.toml.
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

// View depths between which the medium lies before the eye.
DepthRange depths(const EyeInputs& in) {
    const DepthRange all = depthRange(*in.extent, in.pose.position, in.pose.orientation * glm::vec3(0, 0, -1));
    return {std::max(all.near, kNearDepth), all.far};
}
// The medium's standard deviation in pixels, in the middle of the depths where it is.
float projectedDeviation(const EyeInputs& in, float near, float far) {
    const float pixel = 2 * in.block->eye.tan_y / float(in.size.height); // m per m of view depth
    return in.extent->deviation / (pixel * 0.5f * (near + far));
}

// Of the whole picture, but for its rows.
gpu::SlabGrid gridOf(const EyeInputs& in) {
    gpu::SlabGrid grid{};
    auto [near, far] = depths(in);
    far = std::max(far, near + 1e-3f); // all of it behind the eye: slabs without particles
    const float deviation = in.extent->deviation, projected = projectedDeviation(in, near, far);
    grid.rate = in.rate;
    if (grid.rate == 0)
        for (const uint32_t rate : kRates)
            if (grid.rate = rate; float(rate) <= kRaysPerDeviation * projected) break;
    // A row of tiles has bits for all particles.
    const VkDeviceSize bits = in.particle_count / 8; // bytes, of a tile
    while (grid.rate < kRates[0] && gpu::groups(in.size.width, grid.rate * gpu::kSlabTile) * bits > kMostBytes) grid.rate *= 2;
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

// Pixels between those that are shaded.
uint32_t shadingStep(const EyeInputs& in, uint32_t rate) {
    const auto [near, far] = depths(in);
    return in.compose->stepOf(in, rate, projectedDeviation(in, near, std::max(near, far)));
}

} // namespace

void SlabRays::prepare(std::span<const EyeInputs> eyes) {
    if (eyes.empty() || eyes.front().particle_count == 0) return;
    group(eyes);
    fit(field_, most_.field * sizeof(float), "slab field");
    fitRoom(most_);
    eyes.front().compose->fit(most_.shaded);
    const VkDeviceSize bytes = views_.size() * sizeof(gpu::View);
    if (!views_buffer_ || views_buffer_.size() < bytes)
        views_buffer_ = gpu::Buffer(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload, "views");
    std::copy(views_.begin(), views_.end(), views_buffer_.mapped<gpu::View>(views_.size()).begin());
    views_buffer_.flush();
    for (ViewGroup& group : groups_)
        group.block = gpu::storageBuffer(1, views_buffer_, VkDeviceSize(group.views.data() - views_.data()) * sizeof(gpu::View),
                                         group.views.size_bytes());
}

// Views into views_, and groups of them. Those of one eye in several bands, of scenes whose opaque objects are drawn into one
// common target, and whose radiance somebody wants to read are alone.
void SlabRays::group(std::span<const EyeInputs> eyes) {
    order_.clear();
    for (const EyeInputs& in : eyes) order_.push_back(&in);
    const auto kind = [&](const EyeInputs* in) {
        const uint32_t rate = gridOf(*in).rate;
        return std::tuple(in->particles, sources(*in), rate, shadingStep(*in, rate));
    };
    const bool alone = features_.opaque || eyes.front().compose->keepsRadiance();
    if (!alone)
        std::sort(order_.begin(), order_.end(), [&](const EyeInputs* a, const EyeInputs* b) {
            return std::tuple(kind(a), a->view) < std::tuple(kind(b), b->view);
        });
    views_.clear();
    groups_.clear();
    firsts_.clear();
    most_ = {};
    Room room;
    bool open = false; // whether the last group takes more views
    for (const EyeInputs* in : order_) {
        const Bands bands = bandsOf(*in);
        const uint32_t step = shadingStep(*in, bands.grid.rate), count = sources(*in);
        const bool whole = bands.step >= bands.cells && !alone;
        for (uint32_t row = 0; row < bands.cells; row += bands.step) {
            Room with = room;
            gpu::View view = viewOf(*in, bands, row, step, with);
            const auto fits = [&](const ViewGroup& last) {
                return last.any->particles == in->particles && last.rate == bands.grid.rate && last.sources == count &&
                       last.step == step && bytesOfLargest(with) <= kMostBytes;
            };
            if (!(open && whole && fits(groups_.back()))) {
                with = {};
                view = viewOf(*in, bands, row, step, with);
                groups_.push_back({in, {}, {}, bands.grid.rate, count, step, 0});
                firsts_.push_back(views_.size());
            }
            groups_.back().bins = with.bins;
            open = whole;
            room = with;
            views_.push_back(view);
            most_ = {std::max(most_.members, room.members), std::max(most_.bins, room.bins), std::max(most_.added, room.added),
                     std::max(most_.field, room.field), std::max(most_.shaded, room.shaded)};
        }
    }
    firsts_.push_back(views_.size());
    for (size_t g = 0; g < groups_.size(); ++g)
        groups_[g].views = std::span(views_).subspan(firsts_[g], firsts_[g + 1] - firsts_[g]);
}

VkDeviceSize SlabRays::bytesOfLargest(const Room& room) {
    return std::max({room.members * sizeof(gpu::SlabMember), room.bins * sizeof(uint32_t), room.added * sizeof(glm::vec4),
                     room.field * sizeof(float), room.shaded * sizeof(uint32_t)});
}

gpu::View SlabRays::viewOf(const EyeInputs& in, const Bands& bands, uint32_t first_row, uint32_t step, Room& room) const {
    gpu::View view = *in.block;
    view.grid = bands.grid;
    view.grid.first_row = first_row;
    view.first = first_row * bands.grid.rate;
    view.end = std::min(view.first + bands.step * bands.grid.rate, in.size.height);
    view.members = uint32_t(room.members);
    view.bins = uint32_t(room.bins);
    view.added = uint32_t(room.added);
    view.field = uint32_t(room.field);
    view.shaded = uint32_t(room.shaded);
    const Room own = roomOf(in, view.grid, sources(in));
    room.members += own.members;
    room.bins += own.bins;
    room.added += own.added;
    room.field += fieldWords(view.grid, sources(in));
    room.shaded += Compose::shadedWords(view, step);
    return view;
}

void SlabRays::record(gpu::Commands& commands, std::span<const EyeInputs> eyes) {
    if (eyes.empty() || eyes.front().particle_count == 0) return Method::record(commands, eyes);
    const EyeInputs* drawn = nullptr; // whose objects the target holds
    for (const ViewGroup& group : groups_) {
        if (features_.opaque && group.any != drawn) group.any->background->record(commands, *group.any);
        drawn = group.any;
        gpu::everythingBefore(commands.handle()); // the group before has used the same buffers
        recordRays(commands, group);
        if (group.rate > 1) recordSpline(commands, group);
        group.any->compose->record(commands, group, field_);
    }
}

void SlabRays::recordSpline(gpu::Commands& commands, const ViewGroup& group) {
    const gpu::Commands::Pass pass(commands, "spline", group.view());
    made(slab_spline_comp, "slab_spline", group.sources,
         {{gpu::kIdHasOpaque, features_.opaque}, {gpu::kIdSources, group.sources}})
        .bind(commands, {group.block, gpu::storageBuffer(2, field_)});
    const uint32_t nodes = group.most([](const gpu::View& v) { return v.grid.nodes.x * v.grid.nodes.y; });
    vkCmdDispatch(commands.handle(), gpu::groups(nodes, 64), 1, group.count());
    gpu::computeToCompute(commands.handle());
}

VkDeviceSize SlabRays::fieldWords(const gpu::SlabGrid& grid, uint32_t sources) const { // lib/slab_field.glsl
    const uint32_t planes = (sources + 1) * (features_.opaque ? grid.slabs + 3 : 2) + 2;
    return VkDeviceSize(grid.nodes.x) * grid.nodes.y * planes;
}

SlabRays::Bands SlabRays::bandsOf(const EyeInputs& in) const {
    Bands bands{gridOf(in), 0, 0};
    gpu::SlabGrid& grid = bands.grid;
    bands.cells = gpu::groups(in.size.height, grid.rate);
    const auto tooLarge = [&] {
        const Room room{.added = roomOf(in, grid, sources(in)).added, .field = fieldWords(grid, sources(in))};
        return bytesOfLargest(room) > kMostBytes;
    };
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

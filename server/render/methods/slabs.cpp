#include "server/render/methods/slabs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "server/render/compose.h"
#include "shaders/slab_bins_comp.h"
#include "shaders/slab_light_comp.h"
#include "shaders/slabs_comp.h"

namespace brume {
namespace {

// What follows from the medium's band limit; the errors that they leave are measured by tests/bench/sweeps/methods.toml.
constexpr float kRaysPerDeviation = 0.8f;  // spacing of rays in projected standard deviations, at most
constexpr float kSlabsPerDeviation = 0.7f; // thickness of slabs in standard deviations
constexpr uint32_t kMostRate = 16, kLeastSlabs = 8, kMostSlabs = 256;

constexpr uint32_t kRays = gpu::kSlabTile * gpu::kSlabTile;
constexpr VkDeviceSize kMostBytes = 96 << 20; // of a buffer: every device can bind 128 MiB
constexpr float kNearDepth = 0.05f;

class Slabs : public Method {
public:
    explicit Slabs(const MethodContext& context)
        : device_(context.device), features_(context.features),
          bins_program_(device_, {VK_SHADER_STAGE_COMPUTE_BIT, slab_bins_comp, "slab_bins"}) {}

    bool composes() const override { return true; }

    void prepare(std::span<const EyeInputs> eyes) override {
        if (eyes.empty() || eyes.front().particle_count == 0) return;
        VkDeviceSize members = 0, bins = 0, added = 0, field = 0;
        for (const EyeInputs& in : eyes) {
            const Bands bands = bandsOf(in);
            members = std::max(members, in.particle_count * sizeof(gpu::SlabMember));
            bins = std::max(bins, binBytes(bands.grid, in.particle_count));
            added = std::max(added, addedBytes(bands.grid, bands.sources));
            field = std::max(field, fieldBytes(bands.grid, bands.sources));
        }
        fit(members_, members, "slab members");
        fit(bins_, bins, "slab bins", VK_BUFFER_USAGE_TRANSFER_DST_BIT);
        fit(added_, added, "slab extinction");
        fit(field_, field, "slab field");
    }

    void record(gpu::Commands& commands, const EyeInputs& in) override {
        const Bands bands = bandsOf(in);
        gpu::SlabGrid grid = bands.grid;
        gpu::everythingBefore(commands.handle()); // the eye before has used the same buffers
        for (; grid.first_row < bands.cells; grid.first_row += bands.step) {
            recordBand(commands, in, grid, bands.sources);
            const MediumField field{&field_, grid, bands.sources};
            const uint32_t first = grid.first_row * grid.rate, end = std::min(first + bands.step * grid.rate, in.size.height);
            in.compose->record(commands, in, first, end - first, &field);
        }
    }

private:
    // How a picture is made: all of it, or one band of rows of tiles after the other, so that no buffer grows with the picture.
    struct Bands {
        gpu::SlabGrid grid;
        uint32_t cells, step; // rows of cells: all of them, and of one band
        uint32_t sources;
    };

    static uint32_t lines(const gpu::SlabGrid& grid) { return grid.lines.x + grid.lines.y + grid.lines.z; }
    static VkDeviceSize binBytes(const gpu::SlabGrid& grid, uint32_t particles) { // lib/line_pages.glsl
        const uint32_t words = gpu::groups(particles, 32);
        return VkDeviceSize(lines(grid)) * (words + gpu::groups(words, 32 * 64)) * sizeof(uint32_t);
    }
    static VkDeviceSize addedBytes(const gpu::SlabGrid& grid, uint32_t sources) {
        return VkDeviceSize(grid.lines.x) * grid.lines.y * grid.slabs * kRays * (sources > 1 ? 4 : 1) * sizeof(float);
    }
    VkDeviceSize fieldBytes(const gpu::SlabGrid& grid, uint32_t sources) const { // lib/slab_field.glsl
        const uint32_t planes = (sources + 1) * (features_.opaque ? grid.slabs + 2 : 1) + 1;
        return VkDeviceSize(grid.nodes.x) * grid.nodes.y * planes * sizeof(float);
    }

    Bands bandsOf(const EyeInputs& in) const {
        Bands bands{gridOf(in), 0, 0, in.extent->one_albedo ? 1u : features_.ambient ? 6u : 3u};
        gpu::SlabGrid& grid = bands.grid;
        bands.cells = gpu::groups(in.size.height, grid.rate);
        const auto tooLarge = [&] {
            return std::max(addedBytes(grid, bands.sources), fieldBytes(grid, bands.sources)) > kMostBytes;
        };
        const auto rowsOfTiles = [&](uint32_t rows) {
            grid.lines.y = rows;
            grid.nodes.y = rows * gpu::kSlabTile;
        };
        rowsOfTiles(gpu::groups(bands.cells + 3, gpu::kSlabTile));
        while (grid.lines.y > 1 && tooLarge()) rowsOfTiles(gpu::groups(grid.lines.y, 2));
        while (tooLarge()) coarsen(grid);
        // Cubic interpolation reaches three rows of nodes beyond a cell, which the next band has again; even, since compose makes
        // two rows of pixels at a time.
        bands.step = grid.nodes.y - 4;
        return bands;
    }

    static void coarsen(gpu::SlabGrid& grid) {
        grid.thickness *= 2;
        grid.lines.z = gpu::groups(grid.lines.z, 2);
        grid.slabs = grid.lines.z * grid.sheet;
    }

    // Of the whole picture, but for its rows.
    gpu::SlabGrid gridOf(const EyeInputs& in) const {
        gpu::SlabGrid grid{};
        auto [near, far] = depths(in);
        far = std::max(far, near + 1e-3f); // all of it behind the eye: slabs without particles
        const float pixel = 2 * std::tan(0.5f * in.pose.fov_y) / float(in.size.height); // m per m of view depth
        const float deviation = in.extent->deviation, projected = deviation / (pixel * 0.5f * (near + far));
        grid.rate = in.settings->rate;
        if (grid.rate == 0)
            for (grid.rate = kMostRate; grid.rate > 1 && float(grid.rate) > kRaysPerDeviation * projected;) grid.rate /= 2;
        // A row of tiles has bits for all particles.
        while (grid.rate < kMostRate &&
               gpu::groups(in.size.width, grid.rate * gpu::kSlabTile) * (in.particle_count / 8) > kMostBytes)
            grid.rate *= 2;
        const float wanted = std::ceil((far - near) / (kSlabsPerDeviation * deviation));
        const uint32_t slabs = in.settings->slabs ? in.settings->slabs : uint32_t(std::clamp(wanted, 1.0f, float(kMostSlabs)));
        grid.sheet = 8;
        grid.nodes = {gpu::groups(in.size.width, grid.rate) + 3, 0};
        grid.lines = {gpu::groups(grid.nodes.x, gpu::kSlabTile), 0, gpu::groups(std::max(slabs, kLeastSlabs), grid.sheet)};
        grid.slabs = grid.lines.z * grid.sheet;
        grid.depth = near;
        grid.thickness = (far - near) / float(grid.slabs);
        grid.first_caster = in.first_caster;
        grid.albedo = in.extent->albedo;
        return grid;
    }

    // View depths between which the medium lies.
    static std::pair<float, float> depths(const EyeInputs& in) {
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

    void recordBand(gpu::Commands& commands, const EyeInputs& in, const gpu::SlabGrid& grid, uint32_t sources) {
        const VkCommandBuffer cmd = commands.handle();
        {
            const gpu::Commands::Pass pass(commands, "bin", in.view);
            gpu::everythingBefore(cmd);
            vkCmdFillBuffer(cmd, bins_.handle(), 0, binBytes(grid, in.particle_count), 0);
            gpu::transferToCompute(cmd);
            bins_program_.bind(cmd,
                               {in.tick, in.eye, gpu::storageBuffer(2, *in.particles), gpu::storageBuffer(3, members_),
                                gpu::storageBuffer(4, bins_)},
                               grid);
            vkCmdDispatch(cmd, gpu::groups(in.particle_count, 32), 1, 1);
            gpu::computeToCompute(cmd);
        }
        {
            const gpu::Commands::Pass pass(commands, "slabs", in.view);
            slabs(grid.sheet)
                .bind(cmd,
                      {in.tick, in.eye, gpu::storageBuffer(2, members_), gpu::storageBuffer(3, added_),
                       gpu::storageBuffer(4, bins_)},
                      grid);
            vkCmdDispatch(cmd, grid.lines.x, grid.lines.y, grid.lines.z * (sources > 1 ? 4 : 1));
            gpu::computeToCompute(cmd);
        }
        {
            const gpu::Commands::Pass pass(commands, "slab light", in.view);
            light(sources).bind(cmd,
                                {in.tick, in.eye, gpu::storageBuffer(2, added_), gpu::storageBuffer(3, field_),
                                 gpu::sampledImage(6, *in.shadow_volume, *in.linear),
                                 gpu::sampledImage(8, *in.view_depth, *in.nearest)},
                                grid);
            vkCmdDispatch(cmd, grid.lines.x, grid.lines.y, 1);
            gpu::computeToCompute(cmd);
        }
    }

    void fit(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name, VkBufferUsageFlags usage = 0) const {
        if (!buffer || buffer.size() < bytes)
            buffer = gpu::Buffer(device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | usage, gpu::Memory::device, name);
    }

    using Code = std::span<const uint32_t>;
    const gpu::ComputeProgram& made(std::pair<int, uint32_t> key, Code code, const char* name,
                                    std::initializer_list<gpu::SpecConstant> constants) {
        gpu::ComputeProgram& program = programs_[key];
        if (!program) program = gpu::ComputeProgram(device_, {VK_SHADER_STAGE_COMPUTE_BIT, code, name}, constants);
        return program;
    }
    const gpu::ComputeProgram& slabs(uint32_t lanes) { return made({0, lanes}, slabs_comp, "slabs", {{20, lanes}}); }
    const gpu::ComputeProgram& light(uint32_t sources) {
        return made({1, sources}, slab_light_comp, "slab_light", {{0, features_.opaque}, {24, sources}});
    }
    const gpu::Device& device_;
    SceneFeatures features_;
    gpu::ComputeProgram bins_program_;
    std::map<std::pair<int, uint32_t>, gpu::ComputeProgram> programs_; // by shader and what it is specialised for
    gpu::Buffer members_, bins_, added_, field_;
};

} // namespace

std::unique_ptr<Method> makeSlabs(const MethodContext& context) { return std::make_unique<Slabs>(context); }

} // namespace brume

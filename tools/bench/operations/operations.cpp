#include "tools/bench/operations/operations.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "operations/operations_comp.h"
#include "server/gpu/commands.h"
#include "server/gpu/program.h"
#include "tools/bench/operations/names.h"

namespace brume::bench {
namespace {

using namespace operations;

struct Operation {
    uint32_t id;
    const char* text;
    bool indexed = false; // True: it has an index, and a time for each pattern
};

constexpr Operation kOperations[] = {
    {kNothing, "the loop around the others, with the index", true},
    {kLoadFloat, "storage buffer: load of a float", true},
    {kLoadVec2, "load of a vec2", true},
    {kLoadVec4, "load of a vec4", true},
    {kStoreFloat, "store of a float", true},
    {kStoreVec4, "store of a vec4", true},
    {kAtomicAdd, "atomicAdd", true},
    {kFetchFloat, "texelFetch of r32f", true},
    {kFetchVec4, "texelFetch of rgba32f", true},
    {kLinearFloat, "linear look-up in a 2D array of r32f", true},
    {kLinearVec4, "linear look-up in a 2D array of rgba32f", true},
    {kGather, "textureGather of r32f", true},
    {kImageStore, "imageStore of rgba32f", true},
    {kDivide, "division"},
    {kRoot, "sqrt"},
    {kExp2, "exp2"},
    {kLog2, "log2"},
    {kSine, "sin"},
    {kDivideWhole, "division of whole numbers by a variable"},
    {kSums, "16 sums: added to all"},
    {kSumsChosen, "16 sums: added to one, by a variable index"},
    {kBroadcast, "subgroupBroadcastFirst"},
    {kShuffle, "subgroupShuffle"},
    {kSumOfSubgroup, "subgroupAdd"},
    {kBallot, "subgroupBallot"},
    {kLocalIndex, "shared memory, by gl_LocalInvocationIndex"},
    {kSubgroupIndex, "shared memory, by the lane of the subgroup"},
    {kBarrier, "barrier()"},
    {kSubgroupBarrier, "subgroupBarrier()"},
    {kMemoryBarrier, "memoryBarrierShared()"},
    {kLocalIndexAfter, "barrier(), then shared memory by gl_LocalInvocationIndex"},
    {kSubgroupIndexAfter, "barrier(), then shared memory by the lane of the subgroup"},
    {kTaken, "`if` that all lanes take, 16 exp2"},
    {kSkipped, "`if` that no lane takes, 16 exp2"},
    {kSkippedByLane, "the same, with a condition that each lane computes"},
    {kDo, "inner `do … while` of two rounds, 16 exp2 each"},
    {kFor, "inner `for` of two rounds, 16 exp2 each"},
    {kDiverging, "inner `do … while` of one to four rounds by lane, 16 exp2 each"},
};

constexpr uint32_t kLanes = 64;      // of a workgroup, as in the shader
constexpr uint32_t kElements = 4096; // of a buffer and of an image
constexpr uint32_t kWidth = 64;      // of an image
constexpr uint32_t kGroups = 256;
constexpr uint32_t kRounds = 64;              // of the operation, a lane
constexpr uint64_t kTimeout = 60'000'000'000; // ns

class Bench {
public:
    explicit Bench(const gpu::Device& device)
        : device_(device), commands_(device, "operations"), sampler_(device, VK_FILTER_LINEAR) {
        const auto buffer = [&](VkDeviceSize bytes) {
            return gpu::Buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                               gpu::Memory::device, "operations");
        };
        read_ = buffer(kElements * 16), written_ = buffer(kElements * 16);
        results_ = buffer(VkDeviceSize(kGroups) * kLanes * sizeof(float));
        const auto image = [&](VkFormat format, VkImageUsageFlags usage, uint32_t layers) {
            return gpu::Image(device, {format, {kWidth, kElements / kWidth}, usage, layers}, "operations");
        };
        one_ = image(VK_FORMAT_R32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, 1);
        four_ = image(VK_FORMAT_R32G32B32A32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, 1);
        drawn_ = image(VK_FORMAT_R32G32B32A32_SFLOAT, VK_IMAGE_USAGE_STORAGE_BIT, 0);
        const VkCommandBuffer cmd = commands_.begin();
        for (const gpu::Buffer* each : {&read_, &written_, &results_})
            vkCmdFillBuffer(cmd, each->handle(), 0, VK_WHOLE_SIZE, 0);
        for (const gpu::Image* each : {&one_, &four_, &drawn_}) gpu::toGeneral(cmd, *each);
        const VkClearColorValue grey{{0.5f, 0.5f, 0.5f, 0.5f}};
        const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        for (const gpu::Image* each : {&one_, &four_})
            vkCmdClearColorImage(cmd, each->handle(), VK_IMAGE_LAYOUT_GENERAL, &grey, 1, &all);
        gpu::transferToCompute(cmd);
        finish();
    }

    // ns of the device for one operation of a lane.
    double time(const Operation& operation, uint32_t pattern, uint32_t repeats) {
        const gpu::ComputeProgram program(device_, {VK_SHADER_STAGE_COMPUTE_BIT, operations_comp, "operations"},
                                          {{kIdOperation, operation.id}, {kIdPattern, pattern}});
        double least = 0;
        for (uint32_t i = 0; i <= repeats; ++i) { // the first compiles
            const double ms = run(program);
            least = i <= 1 ? ms : std::min(least, ms);
        }
        return 1e6 * least / (double(kGroups) * kLanes * kRounds);
    }

private:
    double run(const gpu::ComputeProgram& program) {
        const VkCommandBuffer cmd = commands_.begin();
        {
            const gpu::Commands::Pass pass(commands_, "operation");
            gpu::everythingBefore(cmd);
            struct Push {
                uint32_t rounds, mask, width, two;
            } push{kRounds, kElements - 1, kWidth, 2};
            program.bind(commands_,
                         {gpu::storageBuffer("Floats", read_), gpu::storageBuffer("Pairs", read_),
                          gpu::storageBuffer("Vectors", read_), gpu::storageBuffer("Stored", written_),
                          gpu::storageBuffer("StoredVectors", written_), gpu::storageBuffer("Counts", written_),
                          gpu::storageBuffer("Results", results_), gpu::sampledImage("one", one_, sampler_),
                          gpu::sampledImage("four", four_, sampler_), gpu::storageImage("drawn", drawn_)},
                         push);
            vkCmdDispatch(cmd, kGroups, 1, 1);
        }
        finish();
        return commands_.readTimes().front().ms;
    }

    void finish() {
        commands_.submit();
        if (!commands_.wait(kTimeout)) throw gpu::Error("an operation took more than a minute");
    }

    const gpu::Device& device_;
    gpu::Commands commands_;
    gpu::Sampler sampler_;
    gpu::Buffer read_, written_, results_;
    gpu::Image one_, four_, drawn_;
};

} // namespace

std::string operationsTable(const gpu::Device& device, uint32_t repeats) {
    Bench bench(device);
    std::string table = "| operation | consecutive | the same for all lanes | scattered |\n|---|---|---|---|\n";
    for (const Operation& operation : kOperations) {
        table += fmt::format("| {} |", operation.text);
        for (const uint32_t pattern : {kConsecutive, kUniform, kScattered})
            table += pattern == kConsecutive || operation.indexed
                         ? fmt::format(" {:.2f} |", bench.time(operation, pattern, repeats))
                         : " |";
        table += '\n';
    }
    return table;
}

} // namespace brume::bench

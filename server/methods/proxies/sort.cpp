#include "server/methods/proxies/sort.h"

#include <algorithm>

#include "shaders/sort_histogram_comp.h"
#include "shaders/sort_scan_comp.h"
#include "shaders/sort_scatter_comp.h"

namespace brume {

using gpu::storageBuffer;

RadixSort::RadixSort(const gpu::Device& device, uint32_t capacity)
    : capacity_(std::max(capacity, 1u)),
      histogram_(device, {VK_SHADER_STAGE_COMPUTE_BIT, sort_histogram_comp, "sort_histogram"}),
      scan_(device, {VK_SHADER_STAGE_COMPUTE_BIT, sort_scan_comp, "sort_scan"}),
      scatter_(device, {VK_SHADER_STAGE_COMPUTE_BIT, sort_scatter_comp, "sort_scatter"}) {
    const auto words = [&](uint64_t count, const char* name) {
        return gpu::Buffer(device, count * sizeof(uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device,
                           name);
    };
    counts_ = words(uint64_t(kDigits) * gpu::groups(capacity_, kBlock), "sort counts");
    keys_ = words(capacity_, "sort keys");
    values_ = words(capacity_, "sort values");
}

void RadixSort::record(gpu::Commands& commands, const gpu::Buffer& keys, const gpu::Buffer& values,
                       uint32_t count) const {
    if (count > capacity_ || keys.size() < count * sizeof(uint32_t) || values.size() < count * sizeof(uint32_t))
        throw gpu::Error("the sort's buffers are too small for " + std::to_string(count) + " pairs");
    if (count < 2) return;
    const VkCommandBuffer cmd = commands.handle();
    const uint32_t blocks = gpu::groups(count, kBlock);
    struct {
        uint32_t count, shift, blocks;
    } push{count, 0, blocks};
    const gpu::Buffer* from[] = {&keys, &values};
    const gpu::Buffer* to[] = {&keys_, &values_};
    for (push.shift = 0; push.shift < 32;
         push.shift += kDigitBits) { // an even number of passes: the result ends where it began
        gpu::computeToCompute(cmd);
        histogram_.bind(commands, {storageBuffer("Keys", *from[0]), storageBuffer("Histogram", counts_)}, push);
        vkCmdDispatch(cmd, blocks, 1, 1);
        gpu::computeToCompute(cmd);
        scan_.bind(commands, {storageBuffer("Histogram", counts_)}, kDigits * blocks);
        vkCmdDispatch(cmd, 1, 1, 1);
        gpu::computeToCompute(cmd);
        scatter_.bind(commands,
                      {storageBuffer("Keys", *from[0]), storageBuffer("Values", *from[1]),
                       storageBuffer("Histogram", counts_), storageBuffer("KeysOut", *to[0]),
                       storageBuffer("ValuesOut", *to[1])},
                      push);
        vkCmdDispatch(cmd, blocks, 1, 1);
        std::swap(from, to);
    }
}

} // namespace brume

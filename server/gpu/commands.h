// Recording: command buffers with their timestamps, barriers as plain functions, and one scope that names, labels and times a
// pass.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include "server/gpu/pass_sample.h"
#include "server/gpu/resource.h"

namespace brume::gpu {

// One command buffer that is recorded and submitted again and again, with its timestamps and its timeline semaphore.
class Commands {
public:
    Commands(const Device& device, const char* name);
    ~Commands();
    Commands(const Commands&) = delete;
    Commands& operator=(const Commands&) = delete;

    // Starts recording anew. Precondition: the last submission is done.
    VkCommandBuffer begin();
    // Ends recording and submits. Throws DeviceLost / Error.
    void submit();
    // True when the last submission is done; waits up to `timeout_ns`. Throws DeviceLost.
    bool wait(uint64_t timeout_ns) const;
    // The passes of the last submission. Precondition: it is done. Valid until begin().
    std::span<const PassSample> readTimes();

    // A new descriptor set for what is recorded next. Valid until begin().
    VkDescriptorSet descriptorSet(VkDescriptorSetLayout layout);

    VkCommandBuffer handle() const { return cmd_; }
    const Device& device() const { return device_; }

    // Names, labels and times what is recorded while it lives.
    class Pass {
    public:
        Pass(Commands& commands, const char* name, uint32_t view = kShared);
        ~Pass();
        Pass(const Pass&) = delete;
        Pass& operator=(const Pass&) = delete;

    private:
        Commands& commands_;
        uint32_t query_;
        bool timed_; // the first kMaxPasses of a submission are
    };

private:
    static constexpr uint32_t kMaxPasses = 1024;
    const Device& device_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer cmd_ = VK_NULL_HANDLE;
    std::vector<VkDescriptorPool> descriptors_; // one more whenever all are full
    size_t filling_ = 0;                        // index of the pool that sets are taken from
    VkQueryPool queries_ = VK_NULL_HANDLE;
    VkQueryPool fragments_ = VK_NULL_HANDLE; // null unless the device counts them
    VkSemaphore timeline_ = VK_NULL_HANDLE;
    uint64_t value_ = 0;
    std::vector<PassSample> passes_;
    std::vector<uint64_t> stamps_, counts_;
};

// --- barriers: what was written before is seen after ---
void computeToCompute(VkCommandBuffer cmd);  // storage writes -> storage and sampled reads and writes in compute
void computeToDraw(VkCommandBuffer cmd);     // storage writes -> indirect arguments, vertex/mesh/fragment reads, colour target
void drawToCompute(VkCommandBuffer cmd);     // colour writes and shader reads -> compute
void transferToCompute(VkCommandBuffer cmd); // copies, fills -> compute
void computeToTransfer(VkCommandBuffer cmd); // compute -> copies
void transferToHost(VkCommandBuffer cmd);    // copies -> CPU reads after the submission is done
// Whatever ran before in this queue is done before what follows, for re-used scratch memory.
void everythingBefore(VkCommandBuffer cmd);
// A new image gets its one and only layout, VK_IMAGE_LAYOUT_GENERAL; what it held is lost.
void toGeneral(VkCommandBuffer cmd, const Image& image);

// Draws follow, into the first `size` pixels of these targets, which keep what they hold; until vkCmdEndRendering.
void beginDrawing(VkCommandBuffer cmd, VkExtent2D size, std::initializer_list<const Image*> targets);

// Groups that cover `count` items.
constexpr uint32_t groups(uint32_t count, uint32_t size) { return (count + size - 1) / size; }

} // namespace brume::gpu

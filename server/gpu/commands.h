// Recording: a command buffer with its timestamps, barriers as plain functions, and Commands::Pass, a scope that
// names, labels and times a pass.
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

    // Starts a new recording. Precondition: the last submission is done.
    VkCommandBuffer begin();
    // Ends recording and submits. Throws DeviceLost / Error.
    void submit();
    // True when the last submission is done; waits up to `timeout_ns`. Throws DeviceLost.
    bool wait(uint64_t timeout_ns) const;
    // Times of the passes of the last submission. Precondition: it is done. Valid until begin().
    std::span<const PassSample> readTimes();

    // A new descriptor set for the commands recorded next. Valid until begin().
    VkDescriptorSet descriptorSet(VkDescriptorSetLayout layout);

    VkCommandBuffer handle() const { return cmd_; }
    const Device& device() const { return device_; }

    // Names, labels and times the commands that are recorded during its lifetime.
    class Pass {
    public:
        Pass(Commands& commands, const char* name, uint32_t view = kShared);
        ~Pass();
        Pass(const Pass&) = delete;
        Pass& operator=(const Pass&) = delete;

    private:
        Commands& commands_;
        uint32_t query_;
        bool timed_; // True: one of the first kMaxPasses of the submission
    };

private:
    void stamp(uint32_t query) const;

    static constexpr uint32_t kMaxPasses = 1024;
    static constexpr uint32_t kPushingQuery = 2 * kMaxPasses; // never read: it follows a stamp that is to be taken
    static constexpr uint32_t kQueries = kPushingQuery + 1;   // two for each pass, and that one
    const Device& device_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer cmd_ = VK_NULL_HANDLE;
    std::vector<VkDescriptorPool> descriptors_; // a new pool is added when all are full
    size_t filling_ = 0;                        // index of the pool that sets are taken from
    VkQueryPool queries_ = VK_NULL_HANDLE;
    VkQueryPool fragments_ = VK_NULL_HANDLE; // null unless the device counts fragments
    VkSemaphore timeline_ = VK_NULL_HANDLE;
    uint64_t value_ = 0;
    std::vector<PassSample> passes_;
    std::vector<uint64_t> stamps_, counts_;
};

// --- barriers: writes before the barrier are visible after it ---
void computeToCompute(VkCommandBuffer cmd);  // storage writes -> storage and sampled reads and writes in compute
void computeToDraw(VkCommandBuffer cmd);     // storage writes -> indirect, vertex/mesh/fragment reads, colour target
void drawToCompute(VkCommandBuffer cmd);     // colour writes and shader reads -> compute
void transferToCompute(VkCommandBuffer cmd); // copies, fills -> compute
void computeToTransfer(VkCommandBuffer cmd); // compute -> copies
void transferToHost(VkCommandBuffer cmd);    // copies -> CPU reads after the submission is done
void computeToHost(VkCommandBuffer cmd);     // storage writes -> CPU reads after the submission is done
// All earlier commands of this queue end before later ones start. For scratch memory that is used again.
void everythingBefore(VkCommandBuffer cmd);
// Moves a new image to VK_IMAGE_LAYOUT_GENERAL, its only layout. Its content is lost.
void toGeneral(VkCommandBuffer cmd, const Image& image);

// Begins draws into the first `size` pixels of these targets, whose content is kept. The caller ends them with
// vkCmdEndRendering.
void beginDrawing(VkCommandBuffer cmd, VkExtent2D size, std::initializer_list<const Image*> targets);

// Number of groups of `size` that cover `count` items.
constexpr uint32_t groups(uint32_t count, uint32_t size) { return (count + size - 1) / size; }

} // namespace brume::gpu

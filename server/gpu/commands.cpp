#include "server/gpu/commands.h"

#include <algorithm>
#include <mutex>

namespace brume::gpu {
namespace {

// Descriptor sets of one pool: what a frame of a few viewers binds.
constexpr uint32_t kSetsOfPool = 256;
// Descriptors of one pool: the passes' average per set, rounded up. A pool that lacks one kind is merely full earlier.
constexpr VkDescriptorPoolSize kDescriptorsOfPool[] = {
    {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 4 * kSetsOfPool},
    {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 2 * kSetsOfPool},
    {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 2 * kSetsOfPool},
    {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 3 * kSetsOfPool},
};

VkDescriptorPool makeDescriptorPool(const Device& device) {
    VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    info.maxSets = kSetsOfPool;
    info.poolSizeCount = uint32_t(std::size(kDescriptorsOfPool));
    info.pPoolSizes = kDescriptorsOfPool;
    VkDescriptorPool pool = VK_NULL_HANDLE;
    check(vkCreateDescriptorPool(device.handle(), &info, nullptr, &pool), "descriptor pool");
    return pool;
}

} // namespace

Commands::Commands(const Device& device, const char* name) : device_(device), stamps_(size_t(2) * kMaxPasses) {
    passes_.reserve(kMaxPasses);
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.queueFamilyIndex = device.queueFamily();
    check(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_), name);
    VkCommandBufferAllocateInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    buffer.commandPool = pool_;
    buffer.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    buffer.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device.handle(), &buffer, &cmd_), name);
    VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = kQueries;
    check(vkCreateQueryPool(device.handle(), &queries, nullptr, &queries_), name);
    if (device.countsFragments()) {
        counts_.resize(kMaxPasses);
        queries.queryType = VK_QUERY_TYPE_PIPELINE_STATISTICS;
        queries.queryCount = kMaxPasses;
        queries.pipelineStatistics = VK_QUERY_PIPELINE_STATISTIC_FRAGMENT_SHADER_INVOCATIONS_BIT;
        check(vkCreateQueryPool(device.handle(), &queries, nullptr, &fragments_), name);
    }
    VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
    type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
    VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type, 0};
    check(vkCreateSemaphore(device.handle(), &semaphore, nullptr, &timeline_), name);
}

Commands::~Commands() {
    if (value_) { // never destroy what the device still uses
        const VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO, nullptr, 0, 1, &timeline_, &value_};
        vkWaitSemaphores(device_.handle(), &info, 10'000'000'000);
    }
    vkDestroySemaphore(device_.handle(), timeline_, nullptr);
    vkDestroyQueryPool(device_.handle(), queries_, nullptr);
    vkDestroyQueryPool(device_.handle(), fragments_, nullptr);
    for (const VkDescriptorPool pool : descriptors_) vkDestroyDescriptorPool(device_.handle(), pool, nullptr);
    vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

VkCommandBuffer Commands::begin() {
    check(vkResetCommandPool(device_.handle(), pool_, 0), "vkResetCommandPool");
    for (const VkDescriptorPool pool : descriptors_)
        check(vkResetDescriptorPool(device_.handle(), pool, 0), "vkResetDescriptorPool");
    filling_ = 0;
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(vkBeginCommandBuffer(cmd_, &info), "vkBeginCommandBuffer");
    vkCmdResetQueryPool(cmd_, queries_, 0, kQueries);
    if (fragments_) vkCmdResetQueryPool(cmd_, fragments_, 0, kMaxPasses);
    passes_.clear();
    return cmd_;
}

VkDescriptorSet Commands::descriptorSet(VkDescriptorSetLayout layout) {
    for (;; ++filling_) {
        const bool fresh = filling_ == descriptors_.size(); // an empty pool without room is an error
        if (fresh) descriptors_.push_back(makeDescriptorPool(device_));
        VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
        info.descriptorPool = descriptors_[filling_];
        info.descriptorSetCount = 1;
        info.pSetLayouts = &layout;
        VkDescriptorSet set = VK_NULL_HANDLE;
        const VkResult result = vkAllocateDescriptorSets(device_.handle(), &info, &set);
        const bool full = result == VK_ERROR_OUT_OF_POOL_MEMORY || result == VK_ERROR_FRAGMENTED_POOL;
        if (full && !fresh) continue;
        check(result, "vkAllocateDescriptorSets");
        return set;
    }
}

void Commands::submit() {
    check(vkEndCommandBuffer(cmd_), "vkEndCommandBuffer");
    VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
    buffer.commandBuffer = cmd_;
    VkSemaphoreSubmitInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
    signal.semaphore = timeline_;
    signal.value = ++value_;
    signal.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &buffer;
    submit.signalSemaphoreInfoCount = 1;
    submit.pSignalSemaphoreInfos = &signal;
    const std::scoped_lock lock(device_.queueMutex());
    check(vkQueueSubmit2(device_.queue(), 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit2");
}

bool Commands::wait(uint64_t timeout_ns) const {
    const VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO, nullptr, 0, 1, &timeline_, &value_};
    const VkResult result = vkWaitSemaphores(device_.handle(), &info, timeout_ns);
    check(result, "vkWaitSemaphores");
    return result == VK_SUCCESS;
}

std::span<const PassSample> Commands::readTimes() {
    if (passes_.empty()) return {};
    const uint32_t count = uint32_t(2 * passes_.size());
    check(vkGetQueryPoolResults(device_.handle(), queries_, 0, count, count * sizeof(uint64_t), stamps_.data(),
                                sizeof(uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
          "vkGetQueryPoolResults");
    const double ms_per_unit = double(device_.properties().limits.timestampPeriod) * 1e-6;
    for (size_t i = 0; i < passes_.size(); ++i) {
        const uint64_t begin = device_.isCpu() && i > 0 ? stamps_[2 * i - 1] : stamps_[2 * i];
        passes_[i].ms = float(double(stamps_[2 * i + 1] - std::min(begin, stamps_[2 * i + 1])) * ms_per_unit);
    }
    if (fragments_) {
        check(vkGetQueryPoolResults(device_.handle(), fragments_, 0, count / 2, count / 2 * sizeof(uint64_t),
                                    counts_.data(), sizeof(uint64_t),
                                    VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
              "vkGetQueryPoolResults");
        for (size_t i = 0; i < passes_.size(); ++i) passes_[i].fragments = counts_[i];
    }
    return passes_;
}

// A CPU driver may take a stamp only when it must: when another follows, or a barrier, but not a dispatch. So on such a
// device a pass begins where the one before it ended, whose stamp the next one has pushed.
void Commands::stamp(uint32_t query) const {
    vkCmdWriteTimestamp2(cmd_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_, query);
}

Commands::Pass::Pass(Commands& commands, const char* name, uint32_t view) : commands_(commands) {
    timed_ = commands.passes_.size() < kMaxPasses;
    query_ = uint32_t(2 * commands.passes_.size());
    if (commands.device_.beginLabel) {
        VkDebugUtilsLabelEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT};
        label.pLabelName = name;
        commands.device_.beginLabel(commands.cmd_, &label);
    }
    if (!timed_) return;
    commands.passes_.push_back({name, view, 0, 0});
    commands.stamp(query_);
    if (query_ == 0 && commands.device_.isCpu()) commands.stamp(kPushingQuery);
    if (commands.fragments_) vkCmdBeginQuery(commands.cmd_, commands.fragments_, query_ / 2, 0);
}

Commands::Pass::~Pass() {
    if (timed_ && commands_.fragments_) vkCmdEndQuery(commands_.cmd_, commands_.fragments_, query_ / 2);
    if (timed_) commands_.stamp(query_ + 1);
    if (commands_.device_.endLabel) commands_.device_.endLabel(commands_.cmd_);
}

namespace {

void barrier(VkCommandBuffer cmd, VkPipelineStageFlags2 from, VkAccessFlags2 written, VkPipelineStageFlags2 to,
             VkAccessFlags2 used) {
    VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr, from, written, to, used};
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &memory;
    vkCmdPipelineBarrier2(cmd, &info);
}

constexpr VkPipelineStageFlags2 kCompute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
constexpr VkPipelineStageFlags2 kCopy = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
constexpr VkPipelineStageFlags2 kDraw = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT |
                                        VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
constexpr VkAccessFlags2 kShaderRead =
    VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT;
constexpr VkAccessFlags2 kShaderWrite = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
constexpr VkAccessFlags2 kTarget = VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;

} // namespace

void computeToCompute(VkCommandBuffer cmd) {
    barrier(cmd, kCompute, kShaderWrite, kCompute, kShaderRead | kShaderWrite);
}
void computeToDraw(VkCommandBuffer cmd) {
    barrier(cmd, kCompute, kShaderWrite, kDraw, kShaderRead | kTarget | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
}
void drawToCompute(VkCommandBuffer cmd) {
    barrier(cmd, kDraw, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, kCompute, kShaderRead | kShaderWrite);
}
void transferToCompute(VkCommandBuffer cmd) {
    barrier(cmd, kCopy, VK_ACCESS_2_TRANSFER_WRITE_BIT, kCompute, kShaderRead | kShaderWrite);
}
void computeToTransfer(VkCommandBuffer cmd) {
    barrier(cmd, kCompute, kShaderWrite, kCopy, VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
}
void transferToHost(VkCommandBuffer cmd) {
    barrier(cmd, kCopy, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}
void computeToHost(VkCommandBuffer cmd) {
    barrier(cmd, kCompute, kShaderWrite, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}
void everythingBefore(VkCommandBuffer cmd) {
    barrier(cmd, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
            VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

void toGeneral(VkCommandBuffer cmd, const Image& image) {
    VkImageMemoryBarrier2 change{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    change.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    change.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT; // of an image whose memory this one takes over
    change.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    change.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    change.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    change.newLayout = VK_IMAGE_LAYOUT_GENERAL;
    change.image = image.handle();
    change.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS};
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &change;
    vkCmdPipelineBarrier2(cmd, &info);
}

void beginDrawing(VkCommandBuffer cmd, VkExtent2D size, std::initializer_list<const Image*> targets) {
    std::vector<VkRenderingAttachmentInfo> attachments;
    for (const Image* image : targets) {
        VkRenderingAttachmentInfo& target = attachments.emplace_back();
        target = {VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
        target.imageView = image->view();
        target.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
        target.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
        target.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    }
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea = {{0, 0}, size};
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = uint32_t(attachments.size());
    rendering.pColorAttachments = attachments.data();
    vkCmdBeginRendering(cmd, &rendering);
    const VkViewport viewport{0, 0, float(size.width), float(size.height), 0, 1};
    const VkRect2D scissor{{0, 0}, size};
    vkCmdSetViewport(cmd, 0, 1, &viewport);
    vkCmdSetScissor(cmd, 0, 1, &scissor);
}

} // namespace brume::gpu

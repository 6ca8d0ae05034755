// Device: owns the Vulkan instance, one device, and one queue for graphics, compute and transfer. No globals.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

#include <vulkan/vulkan.h>

namespace brume::gpu {

// An error that the program cannot continue after. The text is one line and says what to do.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};
// The device stopped answering (VK_ERROR_DEVICE_LOST): the process must be started again.
struct DeviceLost : Error {
    using Error::Error;
};

// Throws Error (or DeviceLost) naming `what` unless `result` is a success code.
void check(VkResult result, const char* what);
std::string resultName(VkResult result);

struct DeviceOptions {
    bool validation = false;  // Khronos layer with synchronization checks; messages are logged and counted
    std::string name;         // part of the wanted device's name; empty: a real GPU first, then a CPU driver
    bool mesh_shaders = true; // use mesh shaders if the device has them
    uint32_t most_lanes = 8;  // bound on Device::lanesTogether(); tests make it smaller
    bool statistics = false;  // count the fragments of every pass if the device can; for measurements
};

class PipelineCache;

class Device {
public:
    explicit Device(const DeviceOptions& options);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkDevice handle() const { return device_; }
    VkPhysicalDevice physical() const { return physical_; }
    VkQueue queue() const { return queue_; }
    std::mutex& queueMutex() const { return queue_mutex_; } // to be locked while something is submitted to queue()
    uint32_t queueFamily() const { return queue_family_; }
    const VkPhysicalDeviceProperties& properties() const { return properties_; }
    std::string name() const { return properties_.deviceName; }
    std::string driver() const; // name and version of the driver
    bool isCpu() const { return properties_.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
    bool hasMeshShaders() const { return mesh_shaders_; }
    uint32_t subgroupSize() const { return subgroup_size_; } // lanes that exchange values; the least, if it varies
    // Lanes of a workgroup that is one subgroup, where shaders want no more than 8: a power of two.
    uint32_t lanesTogether() const { return lanes_together_; }
    // True: a subgroup has no other lanes, and is a vector of one thread, as on CPU drivers.
    bool lockstep() const { return lockstep_; }
    bool countsFragments() const { return counts_fragments_; }

    // Bytes of device memory in use by this program, and the most so far.
    uint64_t memoryInUse() const { return memory_in_use_.load(); }
    uint64_t peakMemory() const { return peak_memory_.load(); }
    uint64_t allocations() const { return allocations_.load(); } // so far
    void countMemory(int64_t bytes) const;
    // Compiled pipelines; programs make them and share them.
    PipelineCache& pipelines() const { return *pipelines_; }

    // Index of a memory type in `type_bits` that has the properties `wanted`, and `preferred` too if possible. Throws
    // Error if there is none.
    uint32_t memoryType(uint32_t type_bits, VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags preferred) const;

    // Number of warnings and errors of the validation layer so far. Tests require zero.
    uint32_t validationMessages() const { return validation_messages_.load(); }

    // Extension functions; null where the device lacks the extension.
    PFN_vkCmdDrawMeshTasksIndirectEXT drawMeshTasksIndirect = nullptr;
    PFN_vkCmdBeginDebugUtilsLabelEXT beginLabel = nullptr;
    PFN_vkCmdEndDebugUtilsLabelEXT endLabel = nullptr;
    PFN_vkSetDebugUtilsObjectNameEXT setName = nullptr;

    // Names an object for validation messages and debuggers.
    void nameObject(VkObjectType type, uint64_t handle, const char* name) const;

private:
    void destroy();
    void createInstance(const DeviceOptions& options);
    void pickPhysicalDevice(const std::string& wanted);
    void createDevice(const DeviceOptions& options);
    static VkBool32 VKAPI_PTR onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                        const VkDebugUtilsMessengerCallbackDataEXT*, void*);

    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkPhysicalDeviceProperties properties_{};
    VkPhysicalDeviceMemoryProperties memory_{};
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    uint32_t queue_family_ = 0;
    bool mesh_shaders_ = false;
    uint32_t subgroup_size_ = 1, lanes_together_ = 1;
    bool lockstep_ = false;
    bool labels_ = false;
    bool counts_fragments_ = false;
    std::unique_ptr<PipelineCache> pipelines_;
    mutable std::mutex queue_mutex_;
    mutable std::atomic<uint64_t> memory_in_use_{0}, peak_memory_{0}, allocations_{0};
    std::atomic<uint32_t> validation_messages_{0};
};

} // namespace brume::gpu

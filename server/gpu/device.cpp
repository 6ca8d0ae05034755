#include "server/gpu/device.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#if defined(__SSE2__)
#include <pmmintrin.h>
#endif

#include <dlfcn.h>
#include <link.h>
#include <spdlog/spdlog.h>

#include "common/cores.h"
#include "server/gpu/pipeline_cache.h"
#include "server/gpu/requirements.h"

namespace brume::gpu {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

// Mesa's CPU driver gives each of its threads one equal run of a dispatch's workgroups. With one thread a core, a core
// idles when its run was easier, or when another thread held the other core up. Several threads a core even that out.
// Who sets LP_NUM_THREADS is obeyed; other drivers do not look at it.
void setDriverThreads() {
    constexpr unsigned kOfCore = 3, kMost = 16; // kMost: that older versions have
    const unsigned cores = usableCores();
    setenv("LP_NUM_THREADS", std::to_string(std::max(cores, std::min(kOfCore * cores, kMost))).c_str(), 0);
}

// Threads that start while it lives take numbers below 1.2e-38 for zero, as GPUs do. A thread begins with the
// floating-point mode of the one that starts it, and Mesa's CPU driver leaves that as it is. x86 adds such numbers up
// to a hundred times as slowly as others, and the tails of Gaussians are full of them.
class TinyIsZero {
public:
#if defined(__SSE2__)
    TinyIsZero() { _mm_setcsr(mode_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
    ~TinyIsZero() { _mm_setcsr(mode_); }

private:
    const unsigned mode_ = _mm_getcsr();
#else
    TinyIsZero() {} // other processors add them fast
    ~TinyIsZero() {}
#endif

public:
    TinyIsZero(const TinyIsZero&) = delete;
    TinyIsZero& operator=(const TinyIsZero&) = delete;
};

bool hasLayer(std::string_view name) {
    uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return name == l.layerName; });
}

bool hasInstanceExtension(std::string_view name) {
    uint32_t count = 0;
    vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateInstanceExtensionProperties(nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return name == e.extensionName; });
}

// With sanitizers drivers and layers stay loaded: a leak is told at the end, and has no name without its library. What
// only a library's globals refer to would count as one.
void keepDrivers() {
#if defined(BRUME_SANITIZED)
    std::vector<std::string> drivers;
    ::dl_iterate_phdr(
        [](dl_phdr_info* library, size_t, void* out) {
            const std::string_view name = library->dlpi_name;
            if (name.find("libvulkan_") != name.npos || name.find("libVkLayer_") != name.npos)
                static_cast<std::vector<std::string>*>(out)->emplace_back(name);
            return 0;
        },
        &drivers);
    for (const std::string& name : drivers) ::dlopen(name.c_str(), RTLD_LAZY | RTLD_NODELETE);
#endif
}

int rank(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return 2;
    default:
        return 3;
    }
}

} // namespace

std::string resultName(VkResult result) {
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        return "out of device memory";
    case VK_ERROR_INITIALIZATION_FAILED:
        return "initialization failed";
    case VK_ERROR_DEVICE_LOST:
        return "device lost";
    case VK_ERROR_FEATURE_NOT_PRESENT:
        return "feature not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
        return "extension not present";
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
        return "format not supported";
    case VK_TIMEOUT:
        return "timeout";
    default:
        return "VkResult " + std::to_string(int(result));
    }
}

void check(VkResult result, const char* what) {
    if (result >= 0) return;
    const std::string text = std::string(what) + ": " + resultName(result);
    if (result == VK_ERROR_DEVICE_LOST)
        throw DeviceLost(text + "; the Vulkan device was lost, start brume-server again");
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        throw Error(text + "; use smaller pictures, fewer viewers or fewer particles");
    throw Error(text);
}

Device::Device(const DeviceOptions& options) : pipelines_(std::make_unique<PipelineCache>()) {
    const TinyIsZero for_its_threads;
    try { // a constructor that throws runs no destructor
        createInstance(options);
        pickPhysicalDevice(options.name);
        const Subgroups groups = subgroups(physical_);
        lanes_together_ = std::min(std::bit_floor(groups.least), options.most_lanes);
        lockstep_ = lanes_together_ == groups.most;
        createDevice(options);
    } catch (const Error&) {
        destroy();
        throw;
    } // Any other exception is the driver's own, thrown through the loader, whose locks it left held: no call comes
      // back
}

Device::~Device() { destroy(); }

void Device::destroy() {
    if (device_) {
        vkDeviceWaitIdle(device_);
        pipelines_.reset();
        vkDestroyDevice(device_, nullptr);
    }
    if (messenger_) {
        const auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        destroy_messenger(instance_, messenger_, nullptr);
    }
    keepDrivers();
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

void Device::createInstance(const DeviceOptions& options) {
    setDriverThreads();
    std::vector<const char*> layers, extensions;
    if (options.validation) {
        if (!hasLayer(kValidationLayer))
            throw Error("the Vulkan validation layer is not installed; install vulkan-validationlayers or leave "
                        "validation off");
        layers.push_back(kValidationLayer);
    }
    labels_ = hasInstanceExtension(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (labels_) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

    VkApplicationInfo app{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    app.pApplicationName = "brume";
    app.apiVersion = VK_API_VERSION_1_3;

    VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    messenger.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = onMessage;
    messenger.pUserData = this;

    const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = enabled;
    features.pNext = &messenger;

    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    if (options.validation && labels_) info.pNext = &features;
    info.pApplicationInfo = &app;
    info.enabledLayerCount = uint32_t(layers.size());
    info.ppEnabledLayerNames = layers.data();
    info.enabledExtensionCount = uint32_t(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        throw Error("no Vulkan driver found; install one (mesa-vulkan-drivers has a CPU driver that works everywhere)");
    check(result, "vkCreateInstance");

    if (options.validation && labels_) {
        const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
        check(create(instance_, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
    }
}

void Device::pickPhysicalDevice(const std::string& wanted) {
    uint32_t count = 0;
    check(vkEnumeratePhysicalDevices(instance_, &count, nullptr), "vkEnumeratePhysicalDevices");
    std::vector<VkPhysicalDevice> devices(count);
    check(vkEnumeratePhysicalDevices(instance_, &count, devices.data()), "vkEnumeratePhysicalDevices");
    if (devices.empty())
        throw Error(
            "no Vulkan device found; install a driver (mesa-vulkan-drivers has a CPU driver that works everywhere)");

    std::string seen;
    int best = 100;
    for (VkPhysicalDevice device : devices) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(device, &properties);
        const std::string lacks = missing(device);
        seen += std::string(seen.empty() ? "" : ", ") + properties.deviceName +
                (lacks.empty() ? "" : " (lacks " + lacks + ")");
        if (!lacks.empty() || std::string_view(properties.deviceName).find(wanted) == std::string_view::npos) continue;
        if (rank(properties.deviceType) < best) {
            best = rank(properties.deviceType);
            physical_ = device;
            properties_ = properties;
        }
    }
    if (!physical_ && !wanted.empty())
        throw Error("no usable Vulkan device has '" + wanted + "' in its name; there are: " + seen);
    if (!physical_) throw Error("no usable Vulkan device: " + seen + "; Mesa 24 or newer has a CPU driver that works");
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
    subgroup_size_ = subgroups(physical_).least;
}

void Device::createDevice(const DeviceOptions& options) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
    const VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    const auto family = std::find_if(families.begin(), families.end(), [&](const auto& f) {
        return (f.queueFlags & needed) == needed && f.timestampValidBits > 0;
    });
    if (family == families.end()) throw Error(name() + " has no queue for graphics, compute and timestamps together");
    queue_family_ = uint32_t(family - families.begin());

    std::vector<const char*> extensions;
    const bool mesh_extension = hasDeviceExtension(physical_, VK_EXT_MESH_SHADER_EXTENSION_NAME);
    Features has(mesh_extension);
    vkGetPhysicalDeviceFeatures2(physical_, &has.all);
    mesh_shaders_ = options.mesh_shaders && mesh_extension && has.mesh.meshShader;
    if (mesh_shaders_) extensions.push_back(VK_EXT_MESH_SHADER_EXTENSION_NAME);

    Features use(mesh_shaders_);
    use.mesh.meshShader = VK_TRUE;
    use.v12.scalarBlockLayout = VK_TRUE;
    use.v12.timelineSemaphore = VK_TRUE;
    use.v12.hostQueryReset = has.v12.hostQueryReset;
    use.v13.dynamicRendering = VK_TRUE;
    use.v13.synchronization2 = VK_TRUE;
    use.v13.maintenance4 = has.v13.maintenance4;
    counts_fragments_ = options.statistics && has.all.features.pipelineStatisticsQuery;
    use.all.features.pipelineStatisticsQuery = counts_fragments_;

    const float priority = 1;
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = queue_family_;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.pNext = &use.all;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = uint32_t(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);

    const auto load = [&](auto& function, const char* function_name) {
        function =
            reinterpret_cast<std::remove_reference_t<decltype(function)>>(vkGetDeviceProcAddr(device_, function_name));
    };
    if (mesh_shaders_) load(drawMeshTasksIndirect, "vkCmdDrawMeshTasksIndirectEXT");
    if (labels_) {
        load(beginLabel, "vkCmdBeginDebugUtilsLabelEXT");
        load(endLabel, "vkCmdEndDebugUtilsLabelEXT");
        load(setName, "vkSetDebugUtilsObjectNameEXT");
    }
}

std::string Device::driver() const {
    VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver, {}};
    vkGetPhysicalDeviceProperties2(physical_, &all);
    return std::string(driver.driverName) + " " + driver.driverInfo;
}

void Device::countMemory(int64_t bytes) const {
    if (bytes > 0) ++allocations_;
    const uint64_t now = memory_in_use_.fetch_add(uint64_t(bytes)) + uint64_t(bytes);
    uint64_t peak = peak_memory_.load();
    while (now > peak && !peak_memory_.compare_exchange_weak(peak, now)) {
    }
}

uint32_t Device::memoryType(uint32_t type_bits, VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags preferred) const {
    for (const VkMemoryPropertyFlags flags : {VkMemoryPropertyFlags(wanted | preferred), wanted})
        for (uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
            if ((type_bits & (1u << i)) && (memory_.memoryTypes[i].propertyFlags & flags) == flags) return i;
    throw Error(name() + " has no memory of the kind that brume needs");
}

void Device::nameObject(VkObjectType type, uint64_t handle, const char* object_name) const {
    if (!setName) return;
    VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
    info.objectType = type;
    info.objectHandle = handle;
    info.pObjectName = object_name;
    setName(device_, &info);
}

VkBool32 VKAPI_PTR Device::onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
    static_cast<Device*>(self)->validation_messages_.fetch_add(1);
    spdlog::error("vulkan: {}", data->pMessage);
    return VK_FALSE;
}

} // namespace brume::gpu

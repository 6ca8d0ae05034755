// Requirements: what a Vulkan device must have to run brume.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <vulkan/vulkan.h>

namespace brume::gpu {

// The chained feature structs of Vulkan 1.1 to 1.3; with those of mesh shaders if the device has their extension.
struct Features {
    VkPhysicalDeviceMeshShaderFeaturesEXT mesh{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT};
    VkPhysicalDeviceVulkan11Features v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};

    explicit Features(bool with_mesh) {
        all.pNext = &v11;
        v11.pNext = &v12;
        v12.pNext = &v13;
        if (with_mesh) v13.pNext = &mesh;
    }
    Features(const Features&) = delete;
    Features& operator=(const Features&) = delete;
};

// Groups of lanes that exchange values.
struct Subgroups {
    VkSubgroupFeatureFlags operations; // in compute shaders
    uint32_t least, most;              // lanes
};

bool hasDeviceExtension(VkPhysicalDevice device, std::string_view name);
Subgroups subgroups(VkPhysicalDevice device);

// The first thing that a device lacks; empty when it can run brume. Each check says what needs it.
std::string missing(VkPhysicalDevice device);

} // namespace brume::gpu

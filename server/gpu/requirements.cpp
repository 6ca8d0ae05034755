#include "server/gpu/requirements.h"

#include <algorithm>
#include <vector>

namespace brume::gpu {
namespace {

// Of compute shaders: `tiles`, `slabs` and `grid` vote and ballot, and with the volumetric shadow map they shuffle.
constexpr VkSubgroupFeatureFlags kSubgroupOperations = VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_VOTE_BIT |
                                                       VK_SUBGROUP_FEATURE_ARITHMETIC_BIT |
                                                       VK_SUBGROUP_FEATURE_BALLOT_BIT | VK_SUBGROUP_FEATURE_SHUFFLE_BIT;

bool hasFormatFeature(VkPhysicalDevice device, VkFormat format, VkFormatFeatureFlags feature) {
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(device, format, &properties);
    return (properties.optimalTilingFeatures & feature) == feature;
}

} // namespace

bool hasDeviceExtension(VkPhysicalDevice device, std::string_view name) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [&](const auto& e) { return name == e.extensionName; });
}

Subgroups subgroups(VkPhysicalDevice device) {
    VkPhysicalDeviceVulkan13Properties v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
    VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES, &v13};
    VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v11, {}};
    vkGetPhysicalDeviceProperties2(device, &all);
    const bool compute = (v11.subgroupSupportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0;
    return {compute ? v11.subgroupSupportedOperations : 0,
            std::min(v11.subgroupSize, std::max(v13.minSubgroupSize, 1u)),
            std::max(v11.subgroupSize, v13.maxSubgroupSize)};
}

std::string missing(VkPhysicalDevice device) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device, &properties);
    if (properties.apiVersion < VK_API_VERSION_1_3) return "Vulkan 1.3"; // the features below are then part of the core
    Features f(false);
    vkGetPhysicalDeviceFeatures2(device, &f.all);
    if (!f.v12.scalarBlockLayout) return "scalarBlockLayout"; // structs of shaders/shared
    if (!f.v12.timelineSemaphore) return "timelineSemaphore"; // Commands: waiting for a submission
    if (!f.v13.dynamicRendering) return "dynamicRendering";   // beginDrawing()
    if (!f.v13.synchronization2) return "synchronization2";   // barriers, timestamps, Commands::submit()
    if ((subgroups(device).operations & kSubgroupOperations) != kSubgroupOperations)
        return "subgroup votes, sums, ballots and shuffles";
    if (properties.limits.maxComputeWorkGroupInvocations < 256) return "workgroups of 256 lanes"; // sort_scan.comp
    if (properties.limits.maxPerStageDescriptorStorageBuffers < 16)
        return "sixteen storage buffers of a shader"; // froxels.comp
    // The opaque shadow map keeps the largest value; the raster methods blend radiance and transmittance.
    if (!hasFormatFeature(device, VK_FORMAT_R32_SFLOAT, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT) ||
        !hasFormatFeature(device, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT))
        return "blending of 32-bit float targets";
    // The volumetric shadow map is interpolated.
    if (!hasFormatFeature(device, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT))
        return "linear filtering of 32-bit floats";
    return {};
}

} // namespace brume::gpu

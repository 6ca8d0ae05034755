// Resources: buffers and images that passes give to shaders, by the names under which shaders declare them. They have
// no numbers: a program looks up what its shaders read (program.h).
#pragma once

#include <string_view>
#include <vector>

#include "server/gpu/resource.h"

namespace brume::gpu {

struct Resource {
    std::string_view name; // name of a buffer's block, or of an image's variable; a literal
    VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    VkDescriptorBufferInfo buffer{};
    VkDescriptorImageInfo image{};

    // The same buffer or image under another name. It also stands in for what a shader declares and never reads.
    Resource as(std::string_view other) const { return {other, type, buffer, image}; }
};
Resource storageBuffer(std::string_view name, const Buffer& buffer, VkDeviceSize offset = 0,
                       VkDeviceSize size = VK_WHOLE_SIZE);
Resource uniformBuffer(std::string_view name, const Buffer& buffer, VkDeviceSize offset, VkDeviceSize size);
Resource storageImage(std::string_view name, const Image& image);
Resource sampledImage(std::string_view name, const Image& image, const Sampler& sampler);

// Resources that several passes read. They may lie within others, which count where these have none of that name.
class Resources {
public:
    Resources() = default;
    // `outer` outlives these, and may change.
    explicit Resources(const Resources* outer) : outer_(outer) {}

    // Adds a resource, in place of the one with this name and type, if there is one.
    void give(const Resource& one);
    // Null: nobody has given it.
    const Resource* find(std::string_view name, VkDescriptorType type) const;
    // The buffer of that name. Precondition: somebody has given it.
    const Resource& storage(std::string_view name) const { return *find(name, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER); }

private:
    const Resources* outer_ = nullptr;
    std::vector<Resource> given_;
};

} // namespace brume::gpu

#include "server/gpu/named_resources.h"

#include <algorithm>

namespace brume::gpu {
namespace {

auto namedIn(auto& resources, std::string_view name, VkDescriptorType type) {
    return std::ranges::find_if(resources, [&](const Resource& r) { return r.type == type && r.name == name; });
}

} // namespace

Resource storageBuffer(std::string_view name, const Buffer& buffer, VkDeviceSize offset, VkDeviceSize size) {
    if (size == VK_WHOLE_SIZE) size = buffer.size() - offset;
    return {name, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, {buffer.handle(), offset, size}, {}};
}

Resource uniformBuffer(std::string_view name, const Buffer& buffer, VkDeviceSize offset, VkDeviceSize size) {
    return {name, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, {buffer.handle(), offset, size}, {}};
}

Resource storageImage(std::string_view name, const Image& image) {
    return {name, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, {}, {VK_NULL_HANDLE, image.view(), VK_IMAGE_LAYOUT_GENERAL}};
}

Resource sampledImage(std::string_view name, const Image& image, const Sampler& sampler) {
    return {
        name, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, {}, {sampler.handle(), image.view(), VK_IMAGE_LAYOUT_GENERAL}};
}

void Resources::give(const Resource& one) {
    const auto same = namedIn(given_, one.name, one.type);
    if (same == given_.end())
        given_.push_back(one);
    else
        *same = one;
}

const Resource* Resources::find(std::string_view name, VkDescriptorType type) const {
    const auto one = namedIn(given_, name, type);
    if (one != given_.end()) return &*one;
    return outer_ ? outer_->find(name, type) : nullptr;
}

} // namespace brume::gpu

#include "server/gpu/resource.h"

#include <algorithm>
#include <string>

namespace brume::gpu {
namespace {

VkMemoryPropertyFlags wantedFlags(Memory memory) {
    switch (memory) {
    case Memory::device:
        return 0;
    case Memory::upload:
        return VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    case Memory::readback:
        return VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
    }
    return 0;
}

VkMemoryPropertyFlags preferredFlags(Memory memory) {
    switch (memory) {
    case Memory::device:
        return VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    case Memory::upload:
        return 0;
    case Memory::readback:
        return VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    }
    return 0;
}

VkImageCreateInfo createInfo(const ImageInfo& what) {
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = what.format;
    info.extent = {what.extent.width, what.extent.height, 1};
    info.mipLevels = 1;
    info.arrayLayers = std::max(what.layers, 1u);
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = what.usage;
    return info;
}

} // namespace

Allocation::Allocation(const Device& device, const VkMemoryRequirements& needs, Memory memory, const char* name)
    : device_(&device), bytes_(needs.size) {
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    info.allocationSize = needs.size;
    info.memoryTypeIndex = device.memoryType(needs.memoryTypeBits, wantedFlags(memory), preferredFlags(memory));
    check(vkAllocateMemory(device.handle(), &info, nullptr, &handle_),
          (std::string(name) + ", " + std::to_string(needs.size >> 20) + " MiB").c_str());
    device.countMemory(int64_t(bytes_));
}

Allocation::~Allocation() {
    if (!handle_) return;
    vkFreeMemory(device_->handle(), handle_, nullptr);
    device_->countMemory(-int64_t(bytes_));
}

Buffer::Buffer(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage, Memory memory, const char* name)
    : device_(device.handle()), size_(size) {
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = size;
    info.usage = usage;
    check(vkCreateBuffer(device_, &info, nullptr, &buffer_), name);
    device.nameObject(VK_OBJECT_TYPE_BUFFER, uint64_t(buffer_), name);
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_, buffer_, &needs);
    try {
        memory_ = Allocation(device, needs, memory, name);
        check(vkBindBufferMemory(device_, buffer_, memory_.handle(), 0), name);
        if (memory != Memory::device) {
            void* pointer = nullptr;
            check(vkMapMemory(device_, memory_.handle(), 0, VK_WHOLE_SIZE, 0, &pointer), name);
            mapped_ = static_cast<std::byte*>(pointer);
        }
    } catch (...) {
        vkDestroyBuffer(device_, buffer_, nullptr);
        throw;
    }
}

Buffer::~Buffer() {
    if (!device_) return;
    vkDestroyBuffer(device_, buffer_, nullptr);
}

void Buffer::atLeast(const Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage, Memory memory,
                     const char* name) {
    if (size_ < bytes) *this = Buffer(device, bytes, usage, memory, name);
}

void Buffer::swap(Buffer& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(memory_, other.memory_);
    std::swap(size_, other.size_);
    std::swap(mapped_, other.mapped_);
}

void Buffer::checkRange(VkDeviceSize offset, VkDeviceSize bytes) const {
    if (!mapped_ || offset > size_ || bytes > size_ - offset)
        throw Error("access to bytes " + std::to_string(offset) + " + " + std::to_string(bytes) +
                    " of a mapped buffer of " + std::to_string(size_));
}

void Buffer::invalidate() const {
    VkMappedMemoryRange range{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, memory_.handle(), 0, VK_WHOLE_SIZE};
    check(vkInvalidateMappedMemoryRanges(device_, 1, &range), "vkInvalidateMappedMemoryRanges");
}

void Buffer::flush() const {
    VkMappedMemoryRange range{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, memory_.handle(), 0, VK_WHOLE_SIZE};
    check(vkFlushMappedMemoryRanges(device_, 1, &range), "vkFlushMappedMemoryRanges");
}

Image::Image(const Device& device, const ImageInfo& info, const char* name) : device_(device.handle()), info_(info) {
    const VkImageCreateInfo create = createInfo(info_);
    check(vkCreateImage(device_, &create, nullptr, &image_), name);
    try {
        memory_ = Allocation(device, needs(device, info_), Memory::device, name);
        bind(device, memory_.handle(), 0, name);
    } catch (...) {
        destroy();
        throw;
    }
}

Image::Image(const Device& device, const ImageInfo& info, const Allocation& memory, VkDeviceSize offset,
             const char* name)
    : device_(device.handle()), info_(info) {
    const VkImageCreateInfo create = createInfo(info_);
    check(vkCreateImage(device_, &create, nullptr, &image_), name);
    try {
        bind(device, memory.handle(), offset, name);
    } catch (...) {
        destroy();
        throw;
    }
}

VkMemoryRequirements Image::needs(const Device& device, const ImageInfo& info) {
    const VkImageCreateInfo create = createInfo(info);
    VkDeviceImageMemoryRequirements image{VK_STRUCTURE_TYPE_DEVICE_IMAGE_MEMORY_REQUIREMENTS};
    image.pCreateInfo = &create;
    VkMemoryRequirements2 needs{VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2};
    vkGetDeviceImageMemoryRequirements(device.handle(), &image, &needs);
    return needs.memoryRequirements;
}

void Image::bind(const Device& device, VkDeviceMemory memory, VkDeviceSize offset, const char* name) {
    device.nameObject(VK_OBJECT_TYPE_IMAGE, uint64_t(image_), name);
    check(vkBindImageMemory(device_, image_, memory, offset), name);
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image_;
    view.viewType = info_.layers ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
    view.format = info_.format;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, std::max(info_.layers, 1u)};
    check(vkCreateImageView(device_, &view, nullptr, &view_), name);
}

Image::~Image() { destroy(); }

void Image::destroy() {
    if (!device_) return;
    vkDestroyImageView(device_, view_, nullptr);
    vkDestroyImage(device_, image_, nullptr);
}

void Image::swap(Image& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(image_, other.image_);
    std::swap(view_, other.view_);
    std::swap(memory_, other.memory_);
    std::swap(info_, other.info_);
}

Sampler::Sampler(const Device& device, VkFilter filter) : device_(device.handle()) {
    VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    info.magFilter = filter;
    info.minFilter = filter;
    info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
    info.addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    info.addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    check(vkCreateSampler(device_, &info, nullptr, &sampler_), "vkCreateSampler");
}

Sampler::~Sampler() {
    if (device_) vkDestroySampler(device_, sampler_, nullptr);
}

} // namespace brume::gpu

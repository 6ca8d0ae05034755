// Buffers, images and samplers that free themselves. Sizes are in bytes; every mapped range is checked against them.
#pragma once

#include <span>
#include <utility>

#include "server/gpu/device.h"

namespace brume::gpu {

enum class Memory {
    device,   // fast for the device, not visible to the CPU
    upload,   // written by the CPU, read by the device
    readback, // written by the device, read by the CPU: cached
};

// Device memory that frees itself. The device counts its bytes.
class Allocation {
public:
    Allocation() = default;
    Allocation(const Device& device, const VkMemoryRequirements& needs, Memory memory, const char* name);
    ~Allocation();
    Allocation(Allocation&& other) noexcept { swap(other); }
    Allocation& operator=(Allocation&& other) noexcept {
        swap(other);
        return *this;
    }
    VkDeviceMemory handle() const { return handle_; }
    VkDeviceSize bytes() const { return bytes_; }
    explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

private:
    void swap(Allocation& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(handle_, other.handle_);
        std::swap(bytes_, other.bytes_);
    }
    const Device* device_ = nullptr;
    VkDeviceMemory handle_ = VK_NULL_HANDLE;
    VkDeviceSize bytes_ = 0;
};

// A buffer with its memory. Upload and readback buffers stay mapped.
class Buffer {
public:
    Buffer() = default;
    Buffer(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage, Memory memory, const char* name);
    ~Buffer();
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
        swap(other);
        return *this;
    }

    // Replaces the buffer if it is smaller than `bytes`; its content is then lost.
    // Precondition: the device does not use a buffer that is replaced.
    void atLeast(const Device& device, VkDeviceSize bytes, VkBufferUsageFlags usage, Memory memory, const char* name);

    VkBuffer handle() const { return buffer_; }
    VkDeviceSize size() const { return size_; }
    explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }

    // The mapped memory of an upload or readback buffer as `count` elements from byte `offset`. Throws Error outside
    // the buffer.
    template <class T>
    std::span<T> mapped(size_t count, VkDeviceSize offset = 0) const {
        checkRange(offset, count * sizeof(T));
        return {reinterpret_cast<T*>(mapped_ + offset), count};
    }
    // Makes the device's writes visible to the CPU (readback) where memory is not coherent.
    void invalidate() const;
    // Makes the CPU's writes visible to the device (upload) where memory is not coherent.
    void flush() const;

private:
    void swap(Buffer& other) noexcept;
    void checkRange(VkDeviceSize offset, VkDeviceSize bytes) const;

    VkDevice device_ = VK_NULL_HANDLE;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    Allocation memory_;
    VkDeviceSize size_ = 0;
    std::byte* mapped_ = nullptr;
};

struct ImageInfo {
    VkFormat format = VK_FORMAT_R32_SFLOAT;
    VkExtent2D extent{1, 1};
    VkImageUsageFlags usage = 0;
    uint32_t layers = 0; // 0: a plain 2D image; otherwise layers of an array
};

class Image {
public:
    Image() = default;
    Image(const Device& device, const ImageInfo& info, const char* name);
    // In `memory` from byte `offset`, as needs() says; `memory` outlives it. Images that overlap lose their content
    // when another is used, and toGeneral() comes first.
    Image(const Device& device, const ImageInfo& info, const Allocation& memory, VkDeviceSize offset, const char* name);
    static VkMemoryRequirements needs(const Device& device, const ImageInfo& info);
    ~Image();
    Image(Image&& other) noexcept { swap(other); }
    Image& operator=(Image&& other) noexcept {
        swap(other);
        return *this;
    }

    VkImage handle() const { return image_; }
    VkImageView view() const { return view_; }
    VkExtent2D extent() const { return info_.extent; }
    uint32_t layers() const { return info_.layers; }
    VkFormat format() const { return info_.format; }
    explicit operator bool() const { return image_ != VK_NULL_HANDLE; }

private:
    void swap(Image& other) noexcept;
    void bind(const Device& device, VkDeviceMemory memory, VkDeviceSize offset, const char* name);
    void destroy();

    VkDevice device_ = VK_NULL_HANDLE;
    VkImage image_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE;
    Allocation memory_;
    ImageInfo info_;
};

class Sampler {
public:
    Sampler() = default;
    // `filter`: linear or nearest. Coordinates beyond the image read its edge.
    Sampler(const Device& device, VkFilter filter);
    ~Sampler();
    Sampler(Sampler&& other) noexcept { swap(other); }
    Sampler& operator=(Sampler&& other) noexcept {
        swap(other);
        return *this;
    }
    VkSampler handle() const { return sampler_; }

private:
    void swap(Sampler& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(sampler_, other.sampler_);
    }
    VkDevice device_ = VK_NULL_HANDLE;
    VkSampler sampler_ = VK_NULL_HANDLE;
};

} // namespace brume::gpu

// onDevice(): numbers that never change, or seldom, in the device's own memory.
#pragma once

#include <algorithm>
#include <vector>

#include "server/gpu/commands.h"

namespace brume {

// Waits for the device.
template <class T>
gpu::Buffer onDevice(const gpu::Device& device, const std::vector<T>& values, const char* name) {
    constexpr uint64_t kSecond = 1'000'000'000; // ns
    const VkDeviceSize bytes = values.size() * sizeof(T);
    const gpu::Buffer staging(device, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::upload, name);
    std::ranges::copy(values, staging.mapped<T>(values.size()).begin());
    staging.flush();
    gpu::Buffer buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                       gpu::Memory::device, name);
    gpu::Commands commands(device, name);
    const VkBufferCopy copy{0, 0, bytes};
    vkCmdCopyBuffer(commands.begin(), staging.handle(), buffer.handle(), 1, &copy);
    gpu::everythingBefore(commands.handle());
    commands.submit();
    while (!commands.wait(kSecond)) {
    }
    return buffer;
}

} // namespace brume

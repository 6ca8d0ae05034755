// Sizes of buffers that shaders are bound to.
#pragma once

#include <cstdint>

namespace brume::gpu {

// Bytes of a buffer that every device can bind: Vulkan has them allow 128 MiB at least (maxStorageBufferRange). What is
// larger is made in bands, or coarser. A quarter is left for what sizes are counted up by.
inline constexpr uint64_t kLargestBinding = 96ull << 20;
// Of one that is bound where nothing is to be read.
inline constexpr uint64_t kLeastBinding = 256;

} // namespace brume::gpu

// GPU radix sort of 32-bit keys with 32-bit values: stable, ascending, the same on every device whatever its subgroup
// size.
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/program.h"

namespace brume {

class RadixSort {
public:
    // For up to `capacity` pairs.
    RadixSort(const gpu::Device& device, uint32_t capacity);

    // Sorts the first `count` pairs in place. The buffers must have been written by compute passes before; a barrier
    // after the sort is the caller's. Throws gpu::Error when a buffer or the capacity is too small.
    void record(gpu::Commands& commands, const gpu::Buffer& keys, const gpu::Buffer& values, uint32_t count) const;

private:
    static constexpr uint32_t kBlock = 1024, kDigitBits = 4, kDigits = 16; // as in shaders/lib/sort.glsl
    uint32_t capacity_;
    gpu::ComputeProgram histogram_, scan_, scatter_;
    gpu::Buffer counts_, keys_, values_;
};

} // namespace brume

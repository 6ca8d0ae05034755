// ObjectBuffers: a scene's opaque objects and their tree in device memory.
#pragma once

#include <algorithm>
#include <vector>

#include "common/scene.h"
#include "server/gpu/resource.h"
#include "shaders/shared/types.h"

namespace brume {

// A buffer that holds the values, and has room for one at least.
template <class T>
gpu::Buffer uploaded(const gpu::Device& device, const std::vector<T>& values, const char* name) {
    gpu::Buffer buffer(device, std::max<size_t>(values.size(), 1) * sizeof(T), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                       gpu::Memory::upload, name);
    std::ranges::copy(values, buffer.mapped<T>(values.size()).begin());
    buffer.flush();
    return buffer;
}

struct ObjectBuffers {
    ObjectBuffers(const gpu::Device& device, const Scene& scene);

    const std::vector<gpu::Opaque> all; // opaqueObjects()
    gpu::Buffer objects;                // gpu::Opaque[]: the same
    gpu::Buffer nodes;                  // gpu::ObjectNode[]: objectNodes()
};

} // namespace brume

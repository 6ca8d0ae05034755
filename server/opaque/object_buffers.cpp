#include "server/opaque/object_buffers.h"

#include <algorithm>

#include "server/opaque/objects.h"

namespace brume {
namespace {

template <class T>
gpu::Buffer bufferOf(const gpu::Device& device, const std::vector<T>& values, const char* name) {
    gpu::Buffer buffer(device, std::max<size_t>(values.size(), 1) * sizeof(T), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                       gpu::Memory::upload, name);
    std::ranges::copy(values, buffer.mapped<T>(values.size()).begin());
    buffer.flush();
    return buffer;
}

} // namespace

ObjectBuffers::ObjectBuffers(const gpu::Device& device, const Scene& scene)
    : all(opaqueObjects(scene)), objects(bufferOf(device, all, "objects")),
      nodes(bufferOf(device, objectNodes(all), "object nodes")) {}

} // namespace brume

#include "server/opaque/object_buffers.h"

#include "server/opaque/objects.h"

namespace brume {
ObjectBuffers::ObjectBuffers(const gpu::Device& device, const Scene& scene)
    : all(opaqueObjects(scene)), objects(uploaded(device, all, "objects")),
      nodes(uploaded(device, objectNodes(all), "object nodes")) {}

} // namespace brume

// ObjectBuffers: a scene's opaque objects and their tree in device memory.
#pragma once

#include <vector>

#include "common/scene.h"
#include "server/gpu/resource.h"
#include "shaders/shared/types.h"

namespace brume {

struct ObjectBuffers {
    ObjectBuffers(const gpu::Device& device, const Scene& scene);

    const std::vector<gpu::Opaque> all; // opaqueObjects()
    gpu::Buffer objects;                // gpu::Opaque[]: the same
    gpu::Buffer nodes;                  // gpu::ObjectNode[]: objectNodes()
};

} // namespace brume

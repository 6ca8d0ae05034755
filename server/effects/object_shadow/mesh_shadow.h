// MeshShadow: how high along to_light the topmost mesh is, seen from the light, and a pyramid of least and largest
// heights. Light shafts are cut by it (shaders/lib/mesh_shadow.glsl).
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "shaders/shared/types.h"

namespace brume {

class MeshShadow {
public:
    explicit MeshShadow(const gpu::Device& device);

    // Records the map. Without meshes it is an image of one texel that nobody reads. `shared`: TickBlock and
    // Triangles. As OpaqueShadow::record otherwise.
    void record(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick);

    const gpu::Image& heights() const { return heights_; }
    const gpu::Buffer& pyramid() const { return pyramid_; }

private:
    void makeImage(VkCommandBuffer cmd, uint32_t size);
    void draw(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick);

    const gpu::Device& device_;
    gpu::Sampler nearest_;
    gpu::Variants heights_program_, pyramid_program_;
    gpu::Image heights_;
    gpu::Buffer pyramid_; // vec2[]: lib/mesh_pyramid.glsl
};

} // namespace brume

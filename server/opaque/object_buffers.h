// ObjectBuffers: a scene's opaque objects and their tree in device memory, as commands have changed them.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "common/bounding_tree.h"
#include "common/scene.h"
#include "server/gpu/resource.h"
#include "server/sim/lists.h"
#include "shaders/shared/types.h"

namespace brume {

// Puts the values into a buffer, which then has room for one at least.
template <class T>
void fill(const gpu::Device& device, gpu::Buffer& buffer, const std::vector<T>& values, const char* name) {
    buffer.atLeast(device, std::max<size_t>(values.size(), 1) * sizeof(T), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                   gpu::Memory::upload, name);
    std::ranges::copy(values, buffer.mapped<T>(values.size()).begin());
    buffer.flush();
}

// How many objects there are of each kind.
struct ObjectCounts {
    uint32_t planes = 0, boxes = 0, spheres = 0;
    bool structure = false; // True: some of the planes have one
    uint32_t bodies() const { return boxes + spheres; }
    auto operator<=>(const ObjectCounts&) const = default; // NOLINT(modernize-use-nullptr): clang-tidy 14: a 0
};
ObjectCounts countsOf(std::span<const gpu::Opaque> objects);

class ObjectBuffers {
public:
    // With the objects that the scene begins with.
    ObjectBuffers(const gpu::Device& device, const Scene& scene);
    // Takes the objects of the lists. True: they differ from those before. Precondition: nothing is on the device.
    bool follow(const Scene& scene, const SceneLists& lists);

    const std::vector<gpu::Opaque>& all() const { return all_; }  // opaqueObjects()
    const ObjectCounts& counts() const { return counts_; }        // of all()
    const gpu::Buffer& objects() const { return objects_; }       // gpu::Opaque[]: all()
    const gpu::Buffer& nodes() const { return nodes_; }           // gpu::ObjectNode[]: objectNodes()
    const gpu::Buffer& reflecting() const { return reflecting_; } // uint32_t[]: reflectingObjects()
    uint32_t reflectingCount() const { return reflecting_count_; }
    const Bounds3& bounds() const { return bounds_; } // m, of boxes and spheres
    uint64_t version() const { return version_; }     // changes with the objects

private:
    void write();

    const gpu::Device& device_;
    std::vector<Plane> planes_; // as follow() took them
    std::vector<Box> boxes_;
    std::vector<Sphere> spheres_;
    std::vector<gpu::Opaque> all_;
    ObjectCounts counts_;
    gpu::Buffer objects_, nodes_, reflecting_;
    uint32_t reflecting_count_ = 0;
    Bounds3 bounds_;
    uint64_t version_ = 0;
};

} // namespace brume

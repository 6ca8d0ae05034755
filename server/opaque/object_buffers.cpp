#include "server/opaque/object_buffers.h"

#include "server/inputs/objects.h"

namespace brume {
ObjectCounts countsOf(std::span<const gpu::Opaque> objects) {
    const auto of = [&](uint32_t kind) { return uint32_t(std::ranges::count(objects, kind, &gpu::Opaque::kind)); };
    const bool structure =
        std::ranges::any_of(objects, [](const gpu::Opaque& o) { return o.kind == gpu::kPlane && o.half_size.x > 0; });
    return {of(gpu::kPlane), of(gpu::kBox), of(gpu::kSphere), structure};
}

ObjectBuffers::ObjectBuffers(const gpu::Device& device, const Scene& scene) : device_(device) {
    const SceneLists lists = listsOf(scene);
    planes_ = lists.planes, boxes_ = lists.boxes, spheres_ = lists.spheres;
    all_ = opaqueObjects(scene);
    write();
}

bool ObjectBuffers::follow(const Scene& scene, const SceneLists& lists) {
    if (planes_ == lists.planes && boxes_ == lists.boxes && spheres_ == lists.spheres) return false;
    planes_ = lists.planes, boxes_ = lists.boxes, spheres_ = lists.spheres;
    all_ = opaqueObjects(scene, lists);
    write();
    return true;
}

void ObjectBuffers::write() {
    counts_ = countsOf(all_);
    fill(device_, objects_, all_, "objects");
    const std::vector<gpu::ObjectNode> nodes = objectNodes(all_);
    fill(device_, nodes_, nodes, "object nodes");
    const std::vector<uint32_t> reflecting = reflectingObjects(all_);
    fill(device_, reflecting_, reflecting, "reflecting objects");
    reflecting_count_ = uint32_t(reflecting.size());
    bounds_ = nodes.empty() ? Bounds3() : Bounds3{nodes.front().lo, nodes.front().hi};
    ++version_;
}

} // namespace brume

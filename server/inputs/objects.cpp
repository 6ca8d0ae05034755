#include "server/inputs/objects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace brume {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

glm::vec3 toward(glm::dvec3 v, float side) {
    glm::vec3 out;
    for (int i = 0; i < 3; ++i) out[i] = std::nextafter(float(v[i]), side);
    return out;
}

} // namespace

std::vector<gpu::Opaque> opaqueObjects(const Scene& scene) {
    std::vector<gpu::Opaque> objects;
    for (const Plane& p : scene.planes)
        objects.push_back({{0, p.height, 0}, gpu::kPlane, {p.structure, p.structure_size, 0}, 1, p.albedo, 0});
    for (const Box& box : scene.boxes) objects.push_back(opaqueOf(box));
    for (const Sphere& sphere : scene.spheres) objects.push_back(opaqueOf(sphere));
    return objects;
}

gpu::Opaque opaqueOf(const Box& box) {
    return {box.centre, gpu::kBox, box.size * 0.5f, std::cos(box.yaw), box.albedo, std::sin(box.yaw)};
}

gpu::Opaque opaqueOf(const Sphere& sphere) {
    return {sphere.centre, gpu::kSphere, glm::vec3(sphere.radius), 1, sphere.albedo, 0};
}

float meanRadius(const gpu::Opaque& body) {
    const glm::vec3 h = body.half_size;
    if (body.kind == gpu::kSphere) return h.x;
    return std::sqrt(2 * (h.x * h.y + h.y * h.z + h.z * h.x) / float(M_PI));
}

gpu::ObjectNode objectNode(const BoundingNode& node) {
    static_assert(BoundingNode::kInner == gpu::kInnerNode);
    return {toward(node.bounds.lo, -kInfinite), node.next, toward(node.bounds.hi, kInfinite), node.item};
}

std::vector<gpu::Opaque> opaqueObjects(Scene scene, const SceneLists& lists) {
    setObjects(scene, lists);
    return opaqueObjects(scene);
}

std::vector<uint32_t> reflectingObjects(std::span<const gpu::Opaque> objects) {
    std::vector<std::pair<float, uint32_t>> found; // minus what each reflects, and its index: the order of equal ones
    for (uint32_t i = 0; i < objects.size(); ++i) {
        const gpu::Opaque& o = objects[i];
        const glm::vec3 h = o.half_size;
        const float area = o.kind == gpu::kSphere ? 12.566371f * h.x * h.x : 8 * (h.x * h.y + h.y * h.z + h.z * h.x);
        const float reflected = area * (o.albedo.x + o.albedo.y + o.albedo.z);
        if (o.kind != gpu::kPlane && reflected > 0) found.emplace_back(-reflected, i);
    }
    std::ranges::sort(found);
    std::vector<uint32_t> indices;
    for (size_t i = 0; i < std::min<size_t>(found.size(), kMostReflecting); ++i) indices.push_back(found[i].second);
    return indices;
}

std::vector<gpu::ObjectNode> objectNodes(std::span<const gpu::Opaque> objects) {
    std::vector<Bounds3> bounds;
    uint32_t planes = 0;
    for (const gpu::Opaque& o : objects) {
        planes += o.kind == gpu::kPlane;
        if (o.kind == gpu::kPlane) continue;
        const glm::dvec3 centre = o.centre, half = o.half_size;
        const double c = std::abs(double(o.yaw_cos)), s = std::abs(double(o.yaw_sin));
        const glm::dvec3 reach = o.kind == gpu::kSphere
                                     ? glm::dvec3(half.x)
                                     : glm::dvec3(c * half.x + s * half.z, half.y, s * half.x + c * half.z);
        bounds.push_back({centre - reach, centre + reach});
    }
    std::vector<gpu::ObjectNode> nodes;
    for (const BoundingNode& node : boundingTree(bounds)) {
        nodes.push_back(objectNode(node));
        if (node.item != BoundingNode::kInner) nodes.back().object += planes;
    }
    return nodes;
}

} // namespace brume

#include "server/opaque/objects.h"

#include <cmath>

namespace brume {

std::vector<gpu::Opaque> opaqueObjects(const Scene& scene) {
    std::vector<gpu::Opaque> objects;
    for (const Plane& p : scene.planes) objects.push_back({{0, p.height, 0}, gpu::kPlane, {0, 0, 0}, 1, p.albedo, 0});
    for (const Box& b : scene.boxes)
        objects.push_back({b.centre, gpu::kBox, b.size * 0.5f, std::cos(b.yaw), b.albedo, std::sin(b.yaw)});
    for (const Sphere& s : scene.spheres)
        objects.push_back({s.centre, gpu::kSphere, glm::vec3(s.radius), 1, s.albedo, 0});
    return objects;
}

} // namespace brume

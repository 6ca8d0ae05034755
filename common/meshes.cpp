#include "common/meshes.h"

#include <cmath>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/gltf/gltf.h"
#include "common/scene_limits.h"
#include "common/text.h"

namespace brume {
namespace {

// In world coordinates less the scene's origin.
glm::dvec3 placed(const Mesh& mesh, glm::dvec3 v) {
    const double c = std::cos(double(mesh.yaw)), s = std::sin(double(mesh.yaw));
    v *= double(mesh.scale);
    return glm::dvec3(mesh.position) + glm::dvec3(c * v.x + s * v.z, v.y, -s * v.x + c * v.z);
}

bool hasArea(const Triangle& t) {
    const glm::dvec3 a = t.corners[0];
    const glm::dvec3 normal = glm::cross(glm::dvec3(t.corners[1]) - a, glm::dvec3(t.corners[2]) - a);
    return glm::dot(normal, normal) > 0;
}

void add(const Mesh& mesh, std::vector<Triangle>& out) {
    const std::string name = oneLine(mesh.file.string());
    const size_t before = out.size();
    const Gltf gltf = loadGltf(mesh.file, size_t(limits::kTriangles.hi) - before);
    for (const GltfTriangle& from : gltf.triangles) {
        Triangle triangle{.corners = {}, .albedo = from.albedo};
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 place = placed(mesh, from.corners[i]);
            for (int axis = 0; axis < 3; ++axis)
                if (!limits::kPlace.holds(place[axis]))
                    throw SceneError(fmt::format("{}: a vertex is {:.4g} m from the scene's origin along an axis; "
                                                 "allowed: within 50 km (mesh.position, mesh.scale)",
                                                 name, place[axis]));
            triangle.corners[i] = place;
        }
        if (hasArea(triangle)) out.push_back(triangle);
    }
    if (out.size() == before) throw SceneError(name + ": no triangle has an area; allowed: some (mesh.scale)");
    for (const std::string& line : gltf.told) spdlog::warn("{}: {}", name, line);
}

} // namespace

std::vector<Triangle> trianglesOf(const std::vector<Mesh>& meshes) {
    std::vector<Triangle> triangles;
    for (const Mesh& mesh : meshes) add(mesh, triangles);
    return triangles;
}

} // namespace brume

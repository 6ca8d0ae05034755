// What is read from files: scenes, point clouds, meshes, costs. A refusal is one line; what is taken is within its
// limits.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/camera.h"
#include "common/gltf/gltf.h"
#include "common/ply/ply.h"
#include "common/ply/upload_frame.h"
#include "common/scene.h"
#include "common/scene_limits.h"
#include "common/tetrahedra.h"
#include "common/volume/volume.h"
#include "server/plan/cost_model.h"
#include "shaders/shared/ellipsoid.h"
#include "tests/fuzz/promise.h"

namespace brume::fuzz {
namespace {

constexpr size_t kLongestRefusal = 2000; // an unknown key is answered with every key that there is

void tetrahedra(const std::string& bytes) {
    try {
        PointCloud cloud = parsePly(bytes, "tetrahedra.ply", {}, {.tetrahedra = true});
        promise(cloud.sigma_t.size() == cloud.position.size(), "corners are complete");
        promise(cloud.vertex.size() == (cloud.dropped > 0 ? cloud.position.size() : 0),
                "those that are left have numbers");
        promise(limits::kTetrahedra.holds(double(cloud.tetrahedra.size())), "a number of tetrahedra within limits");
        const Tetrahedra all = connected(std::move(cloud.tetrahedra), cloud.position, "tetrahedra.ply", cloud.vertex);
        size_t inner = 0;
        for (const glm::uvec4& neighbours : all.neighbours)
            for (int m = 0; m < 4; ++m) {
                promise(neighbours[m] == Tetrahedra::kOutside || neighbours[m] < all.corners.size(), "a neighbour");
                inner += neighbours[m] != Tetrahedra::kOutside;
            }
        promise(inner + all.faces.size() == 4 * all.corners.size(), "every face is inside or outside");
        for (const glm::uvec4& cell : all.corners)
            for (int m = 0; m < 4; ++m) promise(cell[m] < cloud.position.size(), "corners are points");
    } catch (const SceneError& error) {
        promiseOneLine(error.what(), kLongestRefusal);
    }
}

// What an upload is shown by.
void uploaded(const std::string& bytes) {
    constexpr const char* kUps[]{"y", "z", "x", "-y"};
    const std::string up = kUps[bytes.size() % 4];
    try {
        const PlyExtent extent = extentOf(bytes, "points.ply", up);
        promise(extent.radius >= 0 && extent.far <= extent.count, "an extent");
        const UploadFrame frame(extent, {.up = up});
        promise(frame.unit > 0 && std::isfinite(frame.unit), "a unit");
        promise(std::max({std::abs(frame.origin.x), std::abs(frame.origin.y), std::abs(frame.origin.z)}) <=
                    limits::kOrigin.hi,
                "an origin within limits");
        for (const std::string& note : frame.notes) promiseOneLine(note, kLongestRefusal);
        const PointCloud cloud = parsePly(bytes, "points.ply", {.origin = frame.origin, .unit = frame.unit, .up = up},
                                          {.drop_far = true, .most = kMostPlyPoints});
        for (const glm::vec3& at : cloud.position) promise(within(at, limits::kPlace), "a place within limits");
        for (const std::string& note : cloud.notes) promiseOneLine(note, kLongestRefusal);
    } catch (const SceneError& error) {
        promiseOneLine(error.what(), kLongestRefusal);
    }
}

} // namespace

void scene(Bytes input) {
    std::vector<std::string> overrides;
    constexpr std::string_view kSet = "--set ";
    if (const std::string_view text = textOf(input); text.starts_with(kSet)) {
        const size_t end = std::min(text.find('\n'), text.size());
        overrides.emplace_back(text.substr(kSet.size(), end - kSet.size()));
        input = input.subspan(std::min(end + 1, input.size()));
    }
    try {
        const Scene scene = loadScene(asFile(input), overrides);
        const Medium& medium = scene.medium;
        promise(limits::kCount.holds(medium.count) && limits::kFalloff.holds(medium.falloff) &&
                    limits::kExtinction.holds(medium.extinction) && within(medium.albedo, limits::kColour),
                "a medium within limits");
        promise(medium.scale.lo <= medium.scale.hi && limits::kScale.holds(medium.scale.lo) &&
                    limits::kScale.holds(medium.scale.hi),
                "sizes within limits");
        promise(isFromFiles(medium.layout) == !medium.file.empty(), "a file only where it is used");
        for (const Light& light : scene.lights)
            promise(std::abs(glm::length(light.to_light) - 1) < 1e-3f &&
                        std::abs(glm::length(light.axis) - 1) < 1e-3f && light.inner < light.outer,
                    "lights with unit directions, and cones that are not empty");
        promise(scene.lights.size() - localLightsOf(scene).size() <= 1, "one directional light at most");
        promise(limits::kPlanes.holds(double(scene.planes.size())) &&
                    limits::kObjects.holds(double(scene.boxes.size() + scene.spheres.size())),
                "no endless lists of objects");
        promise(isUsable(lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y)), "a camera is usable");
    } catch (const SceneError& error) {
        promiseOneLine(error.what(), kLongestRefusal);
    }
}

void ply(Bytes input) {
    const std::string bytes(textOf(input)); // exactly so long
    try {
        const PlyContents contents = contentsOf(bytes, "points.ply");
        const PointCloud cloud =
            parsePly(bytes, "points.ply", {},
                     {.ids = bytes.size() % 2 == 1, .axes = contents.axes, .velocities = bytes.size() % 2 == 1});
        for (const gpu::EllipsoidAxes& axes : cloud.axes)
            for (const glm::vec3 axis : {axes.a, axes.b, axes.c})
                promise(glm::length(axis) > 0.99f * gpu::kLeastAxis && glm::length(axis) < 1.001f, "an axis");
        promise(cloud.velocity.empty() || cloud.velocity.size() == cloud.position.size(), "velocities are complete");
        promise(cloud.axes.size() == (contents.axes ? cloud.position.size() : 0), "axes are complete");
        const size_t points = cloud.position.size();
        promise(limits::kCount.holds(double(points)), "a number of points within limits");
        promise(points + cloud.dropped <= bytes.size(), "every point has bytes of its own");
        for (const size_t size : {cloud.scale.size(), cloud.radius.size(), cloud.deviation.size(), cloud.sigma_t.size(),
                                  cloud.opacity.size(), cloud.albedo.size(), cloud.id.size()})
            promise(size == 0 || size == points, "a list is empty or complete");
        for (const glm::vec3& at : cloud.position) promise(within(at, limits::kPlace), "a place within limits");
        for (const float scale : cloud.scale) promise(limits::kScale.holds(double(scale)), "a size within limits");
        for (const float radius : cloud.radius) promise(limits::kScale.holds(double(radius)), "a size within limits");
        for (const float deviation : cloud.deviation)
            promise(deviation >= 0 && double(deviation) <= limits::kScale.hi, "a size within limits");
        for (const float opacity : cloud.opacity)
            promise(limits::kColour.holds(double(opacity)), "an opacity within limits");
        for (const float sigma_t : cloud.sigma_t)
            promise(limits::kSigmaT.holds(double(sigma_t)), "an extinction within limits");
        for (const glm::vec3& albedo : cloud.albedo)
            promise(within(albedo, limits::kColour), "an albedo within limits");
        for (const int64_t id : cloud.id) promise(id >= -(1ll << 31) && id < 1ll << 32, "an id of 32 bits");
    } catch (const SceneError& error) {
        promiseOneLine(error.what(), kLongestRefusal);
    }
    tetrahedra(bytes);
    uploaded(bytes);
}

void volume(Bytes input) {
    constexpr uint64_t kMost = 4096; // nodes
    constexpr const char* kUps[]{"y", "z", "x", "-y"};
    const std::string bytes(textOf(input));
    try {
        const Volume volume = parseVolume(bytes, "v.nrrd", {.unit = 0.5, .up = kUps[bytes.size() % 4]}, kMost);
        promise(volume.extinction.size() == size_t(volume.size.x) * volume.size.y * volume.size.z, "all voxels");
        promise(volume.nodes() <= kMost, "a number of nodes within limits");
        promise(volume.spacing > 0 && std::isfinite(volume.spacing), "a spacing");
        promise(within(glm::vec3(volume.origin), limits::kPlace), "a place within limits");
        for (const float extinction : volume.extinction)
            promise(limits::kSigmaT.holds(double(extinction)), "an extinction within limits");
        for (const std::string& note : volume.notes) promiseOneLine(note, kLongestRefusal);
    } catch (const SceneError& error) {
        promiseOneLine(error.what(), kLongestRefusal);
    }
}

void gltf(Bytes input) {
    constexpr size_t kMost = 1000;                       // triangles
    constexpr size_t kMostTold = 16, kLongestTold = 250; // lines; bytes of each
    try {
        const Gltf gltf = parseGltf(textOf(input), "mesh.glb", "/nowhere", kMost);
        promise(!gltf.triangles.empty() && gltf.triangles.size() <= kMost, "a number of triangles within limits");
        for (const GltfTriangle& triangle : gltf.triangles) {
            promise(within(triangle.albedo, limits::kColour), "an albedo within limits");
            for (const glm::dvec3& corner : triangle.corners)
                promise(std::isfinite(corner.x + corner.y + corner.z), "a finite place");
        }
        promise(gltf.told.size() <= kMostTold, "few lines on what was left out");
        for (const std::string& line : gltf.told) promiseOneLine(line.c_str(), kLongestTold);
    } catch (const SceneError& error) {
        promiseOneLine(error.what(), kLongestRefusal);
    }
}

void costs(Bytes input) {
    std::string complaint;
    const CostModel model = loadCosts(asFile(input), complaint);
    promise(!model.calibrated || complaint.empty(), "a file whose costs hold has nothing to complain of");
    if (!complaint.empty()) promiseOneLine(complaint, kLongestRefusal);
    if (!model.calibrated) promise(model.ns == builtInCosts().ns, "without a file the built-in costs hold");
    for (const CostInfo* cost : allCosts())
        promise(model[*cost] > 0 && std::isfinite(model[*cost]), "every cost is a positive number");
}

} // namespace brume::fuzz

#include "common/gltf/primitives.h"

#include <array>
#include <cmath>

#include "common/gltf/materials.h"
#include "common/gltf/nodes.h"
#include "common/gltf/vertices.h"
#include "common/scene_limits.h"

namespace brume::gltf {
namespace {

constexpr size_t kTriangles = 4, kStrip = 5, kFan = 6; // modes; those below are points and lines

constexpr size_t kMostPrimitives = 1'000'000; // each at every node that has its mesh

// Three of the corners that a primitive lists.
using Corners = std::array<size_t, 3>;

Corners cornersOf(size_t mode, size_t i) {
    if (mode == kFan) return {0, i + 1, i + 2};
    if (mode == kStrip) return i % 2 == 0 ? Corners{i, i + 1, i + 2} : Corners{i + 1, i, i + 2};
    return {3 * i, 3 * i + 1, 3 * i + 2};
}

class Reader {
public:
    Reader(File& file, size_t most) : file_(file), most_(most), left_(most), materials_(file) {}

    std::vector<GltfTriangle> read() {
        size_t primitives = 0;
        forEachMesh(file_, most_, [&](const MeshNode& at) {
            for (const Json& primitive : listIn(at.mesh, "primitives")) {
                if (++primitives > kMostPrimitives) fail("more than {} primitives at its nodes", kMostPrimitives);
                readPrimitive(primitive, at);
            }
        });
        if (const Json& animations = listIn(file_.root(), "animations"); !animations.empty())
            file_.told.add("animations are ignored", animations.size(), "animation");
        return std::move(out_);
    }

private:
    void leaveOut(const char* what) { file_.told.add(what, 1, "primitive"); }

    void readPrimitive(const Json& primitive, const MeshNode& at) {
        const size_t mode = wholeIn(primitive, "mode").value_or(kTriangles);
        const std::optional<size_t> positions = wholeIn(member(primitive, "attributes"), "POSITION");
        if (mode > kFan) fail("a primitive of mode {}; allowed: 0 to {}", mode, kFan);
        if (mode < kTriangles) return leaveOut("points and lines are left out");
        if (!positions) return leaveOut("what has no POSITION is left out");
        checkCompression(primitive, *positions);
        Vertices vertices(file_, primitive, at);
        if (vertices.ignoresSkin() && at.stands_unskinned) return; // it would be there twice
        std::optional<Accessor> indices;
        if (const std::optional<size_t> index = wholeIn(primitive, "indices")) {
            indices.emplace(file_, *index, Shape::scalar);
            if (!indices->isWhole()) fail("accessors[{}] holds indices that are no unsigned whole numbers", *index);
        }
        const size_t corners = indices ? indices->count() : vertices.count();
        if (corners == 0 || vertices.count() == 0) return leaveOut("what has no vertices is left out");
        if (corners < 3) return leaveOut("what has fewer than three corners is left out");
        const size_t count = mode == kTriangles ? corners / 3 : corners - 2;
        if (mode == kTriangles && corners % 3 != 0) leaveOut("corners behind the last whole triangle are left out");
        if (at.worlds.empty()) return;
        if (count > left_ / at.worlds.size())
            fail("more than {} triangles; a scene may have {} in all", most_, size_t(limits::kTriangles.hi));
        left_ -= count * at.worlds.size();
        const Material& material = materials_.read(wholeIn(primitive, "material"));
        const bool textured = material.texture.image && vertices.hasSet(material.texture.set);
        size_t hidden = 0;
        for (size_t i = 0; i < count; ++i) {
            Corners of = cornersOf(mode, i);
            for (size_t& corner : of) {
                if (indices) corner = indices->whole(corner);
                if (corner >= vertices.count())
                    fail("index {} of a primitive with {} vertices", corner, vertices.count());
            }
            const glm::vec4 colour = colourOf(of, material, vertices, textured);
            if (material.hides(colour.a))
                ++hidden;
            else
                for (const glm::dmat4& world : at.worlds) add(of, world, colour, vertices);
        }
        file_.told.add("what is below its alpha cut-off, or has no alpha, is left out", hidden, "triangle");
    }

    // Files that are compressed have places in the extension alone.
    void checkCompression(const Json& primitive, size_t positions) const {
        const Json& accessor = file_.at("accessors", positions);
        if (!extension(primitive, "KHR_draco_mesh_compression").is_null() && member(accessor, "bufferView").is_null())
            fail("places are there in extension KHR_draco_mesh_compression alone; export it without compression");
    }

    static glm::vec4 colourOf(const Corners& of, const Material& material, const Vertices& vertices, bool textured) {
        const glm::dvec4 mean = (vertices.colour(of[0]) + vertices.colour(of[1]) + vertices.colour(of[2])) / 3.0;
        glm::vec4 colour = material.factor * glm::vec4(mean);
        if (textured)
            colour *= material.texture.colourOf(
                {vertices.coordinates(of[0]), vertices.coordinates(of[1]), vertices.coordinates(of[2])});
        else if (material.texture.image)
            colour *= material.texture.image->mean();
        for (int part = 0; part < 4; ++part) colour[part] = colour[part] > 0 ? std::min(colour[part], 1.0f) : 0;
        return colour;
    }

    void add(const Corners& of, const glm::dmat4& world, const glm::vec4& colour, const Vertices& vertices) {
        GltfTriangle& triangle = out_.emplace_back();
        triangle.albedo = glm::vec3(colour);
        for (size_t c = 0; c < 3; ++c) {
            triangle.corners[c] = vertices.place(of[c], world);
            for (int axis = 0; axis < 3; ++axis)
                if (!std::isfinite(triangle.corners[c][axis])) fail("vertex {} is at no finite place", of[c]);
        }
    }

    File& file_;
    size_t most_, left_; // triangles
    Materials materials_;
    std::vector<GltfTriangle> out_;
};

} // namespace

std::vector<GltfTriangle> trianglesOf(File& file, size_t most) { return Reader(file, most).read(); }

} // namespace brume::gltf

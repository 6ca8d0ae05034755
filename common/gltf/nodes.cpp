#include "common/gltf/nodes.h"

#include <array>
#include <bit>
#include <map>
#include <set>

#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "common/gltf/accessors.h"

namespace brume::gltf {
namespace {

// A rotation in few bits is no unit quaternion.
glm::dmat4 transformOf(glm::dvec3 translation, glm::dvec4 rotation, glm::dvec3 scale) {
    const double length = glm::length(rotation);
    rotation = length > 0 ? rotation / length : glm::dvec4(0, 0, 0, 1);
    glm::dmat4 out = glm::mat4_cast(glm::dquat(rotation.w, rotation.x, rotation.y, rotation.z));
    for (int axis = 0; axis < 3; ++axis) out[axis] *= scale[axis];
    out[3] = glm::dvec4(translation, 1);
    return out;
}

glm::dmat4 transformOf(const Json& node) {
    glm::dmat4 matrix(1);
    if (numbersIn(node, "matrix", {glm::value_ptr(matrix), 16})) return matrix;
    glm::dvec3 translation(0), scale(1);
    glm::dvec4 rotation(0, 0, 0, 1);
    numbersIn(node, "translation", {glm::value_ptr(translation), 3});
    numbersIn(node, "rotation", {glm::value_ptr(rotation), 4});
    numbersIn(node, "scale", {glm::value_ptr(scale), 3});
    return transformOf(translation, rotation, scale);
}

class Walk {
public:
    Walk(File& file, size_t most)
        : file_(file), most_(most), world_(listIn(file.root(), "nodes").size()), visited_(world_.size()) {}

    void walk(const std::function<void(const MeshNode&)>& use) {
        struct Visit {
            size_t node;
            glm::dmat4 parent;
            bool visible;
        };
        std::vector<Visit> left;
        std::vector<std::pair<size_t, size_t>> meshes; // nodes and their meshes
        for (const size_t root : roots()) left.push_back({root, glm::dmat4(1), true});
        while (!left.empty()) {
            auto [index, parent, visible] = left.back();
            left.pop_back();
            const Json& node = file_.at("nodes", index);
            if (visited_[index]) fail("nodes[{}] is there twice, or in itself", index);
            visited_[index] = true;
            world_[index] = parent * transformOf(node);
            visible = visible && flagIn(extension(node, "KHR_node_visibility"), "visible", true);
            if (const std::optional<size_t> mesh = wholeIn(node, "mesh")) {
                if (visible)
                    meshes.emplace_back(index, *mesh);
                else
                    file_.told.add("hidden nodes are left out", 1, "mesh");
            }
            for (const Json& child : listIn(node, "children"))
                left.push_back({wholeOf(child, "a child of a node"), world_[index], visible});
        }
        notePlain(meshes);
        for (const auto& [node, mesh] : meshes) use(placed(node, mesh));
        if (!world_.empty() || !listIn(file_.root(), "scenes").empty()) return;
        const Json no_node;
        for (const Json& mesh : listIn(file_.root(), "meshes")) use({no_node, mesh, {glm::dmat4(1)}, {}});
    }

private:
    using Placed = std::pair<size_t, std::array<uint64_t, 16>>; // a mesh, and the bits of its matrix

    Placed placedPlain(size_t node, size_t mesh) const {
        Placed out{mesh, {}};
        for (size_t part = 0; part < 16; ++part)
            out.second[part] = std::bit_cast<uint64_t>(glm::value_ptr(world_[node])[part] + 0.0); // no -0
        return out;
    }

    // Meshes as they are, without a skin, copies or morphs of their own.
    void notePlain(const std::vector<std::pair<size_t, size_t>>& meshes) {
        if (listIn(file_.root(), "skins").empty()) return;
        for (const auto& [index, mesh] : meshes) {
            const Json& node = file_.at("nodes", index);
            if (member(node, "skin").is_null() && member(node, "weights").is_null() &&
                extension(node, "EXT_mesh_gpu_instancing").is_null())
                plain_.insert(placedPlain(index, mesh));
        }
    }

    std::vector<size_t> roots() const {
        std::vector<size_t> out;
        const Json& scenes = listIn(file_.root(), "scenes");
        const std::optional<size_t> scene = wholeIn(file_.root(), "scene");
        if (scene || !scenes.empty()) {
            for (const Json& node : listIn(file_.at("scenes", scene.value_or(0)), "nodes"))
                out.push_back(wholeOf(node, "a node of the scene"));
            return out;
        }
        std::vector<bool> is_child(world_.size());
        for (const Json& node : listIn(file_.root(), "nodes"))
            for (const Json& child : listIn(node, "children")) {
                const size_t index = wholeOf(child, "a child of a node");
                file_.at("nodes", index);
                is_child[index] = true;
            }
        for (size_t node = 0; node < world_.size(); ++node)
            if (!is_child[node]) out.push_back(node);
        return out;
    }

    MeshNode placed(size_t index, size_t mesh_index) {
        const Json &mesh = file_.at("meshes", mesh_index), &node = file_.at("nodes", index);
        if (const std::optional<size_t> skin = wholeIn(node, "skin")) {
            const auto [found, fresh] = joints_.try_emplace(*skin);
            if (fresh) found->second = jointsOf(*skin);
            const bool plain = member(node, "weights").is_null() && plain_.contains(placedPlain(index, mesh_index));
            return {node, mesh, {world_[index]}, found->second, plain};
        }
        const Json& copies = member(extension(node, "EXT_mesh_gpu_instancing"), "attributes");
        if (copies.is_null()) return {node, mesh, {world_[index]}, {}};
        return {node, mesh, copiesOf(copies, world_[index]), {}};
    }

    // World from the mesh for each joint, in the pose that the file's nodes have. Empty if it cannot be applied.
    std::vector<glm::dmat4> jointsOf(size_t index) {
        const Json& skin = file_.at("skins", index);
        std::vector<glm::dmat4> out;
        for (const Json& joint : listIn(skin, "joints")) {
            const size_t node = wholeOf(joint, "a joint of a skin");
            file_.at("nodes", node);
            if (!visited_[node]) return {};
            out.push_back(world_[node]);
        }
        const std::optional<size_t> inverse = wholeIn(skin, "inverseBindMatrices");
        if (!inverse) return out;
        const Accessor matrices(file_, *inverse, Shape::mat4);
        if (matrices.count() < out.size())
            fail("skins[{}] has {} joints, and {} matrices", index, out.size(), matrices.count());
        for (size_t i = 0; i < out.size(); ++i) {
            glm::dmat4 matrix;
            for (size_t part = 0; part < 16; ++part) glm::value_ptr(matrix)[part] = matrices.number(i, part);
            out[i] *= matrix;
        }
        return out;
    }

    std::vector<glm::dmat4> copiesOf(const Json& attributes, const glm::dmat4& world) {
        const auto columnOf = [&](const char* name, Shape shape) {
            const std::optional<size_t> index = wholeIn(attributes, name);
            return index ? std::optional<Accessor>(Accessor(file_, *index, shape)) : std::nullopt;
        };
        const std::optional<Accessor> translation = columnOf("TRANSLATION", Shape::vec3),
                                      rotation = columnOf("ROTATION", Shape::vec4),
                                      scale = columnOf("SCALE", Shape::vec3);
        std::optional<size_t> count;
        for (const std::optional<Accessor>* column : {&translation, &rotation, &scale}) {
            if (!*column) continue;
            if (count.value_or((*column)->count()) != (*column)->count())
                fail("EXT_mesh_gpu_instancing with lists of {} and {} copies", *count, (*column)->count());
            count = (*column)->count();
        }
        if (!count) return {world};
        if (*count == 0) file_.told.add("nodes of no copies are left out", 1, "mesh");
        if (*count > left_) fail("EXT_mesh_gpu_instancing with more than {} copies in all", most_);
        left_ -= *count;
        std::vector<glm::dmat4> out;
        for (size_t i = 0; i < *count; ++i) {
            const glm::dvec4 turn =
                rotation ? glm::dvec4(rotation->vec3(i), rotation->number(i, 3)) : glm::dvec4(0, 0, 0, 1);
            out.push_back(world * transformOf(translation ? translation->vec3(i) : glm::dvec3(0), turn,
                                              scale ? scale->vec3(i) : glm::dvec3(1)));
        }
        return out;
    }

    File& file_;
    size_t most_, left_ = most_;    // copies
    std::vector<glm::dmat4> world_; // from each node that was visited
    std::vector<bool> visited_;
    std::map<size_t, std::vector<glm::dmat4>> joints_; // matrices of each skin's joints
    std::set<Placed> plain_;
};

} // namespace

void forEachMesh(File& file, size_t most, const std::function<void(const MeshNode&)>& use) {
    Walk(file, most).walk(use);
}

} // namespace brume::gltf

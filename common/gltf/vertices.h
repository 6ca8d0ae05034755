// Vertices: attributes of a primitive's vertices.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/gltf/accessors.h"
#include "common/gltf/nodes.h"

namespace brume::gltf {

class Vertices {
public:
    // Of a primitive of a mesh that stands at a node. The file must outlast it. Attributes that only lend colour are
    // left out where they cannot be read.
    Vertices(File& file, const Json& primitive, const MeshNode& at);

    size_t count() const { return places_.count(); }
    // True: the node has a skin that cannot be applied.
    bool ignoresSkin() const { return ignores_skin_; }
    // Where vertex i stands by one of the node's matrices; one with a skin stands by its joints.
    glm::dvec3 place(size_t i, const glm::dmat4& world) const;
    // Linear, (1, 1, 1, 1) without colours.
    glm::dvec4 colour(size_t i) const;
    // True: there are texture coordinates of this set.
    bool hasSet(size_t set);
    glm::dvec2 coordinates(size_t i) const; // texture coordinates of the set that hasSet() was asked last

private:
    struct Influence {
        Accessor joints, weights; // of four joints a vertex
    };

    std::optional<Accessor> ofColour(const std::string& name, Shape shape, Shape other);
    void readMorphs(const Json& primitive, const MeshNode& at);
    void readSkin(const MeshNode& at);

    File& file_;
    const Json& attributes_;
    Accessor places_;
    std::optional<Accessor> colours_, coordinates_;
    std::vector<std::pair<double, Accessor>> morphs_; // weights, movements
    std::vector<Influence> influences_;
    std::span<const glm::dmat4> joints_;
    bool ignores_skin_ = false;
};

} // namespace brume::gltf

#include "common/gltf/vertices.h"

#include <algorithm>

namespace brume::gltf {

Vertices::Vertices(File& file, const Json& primitive, const MeshNode& at)
    : file_(file), attributes_(member(primitive, "attributes")),
      places_(file, wholeIn(attributes_, "POSITION").value_or(0), Shape::vec3), joints_(at.joints) {
    colours_ = ofColour("COLOR_0", Shape::vec3, Shape::vec4);
    readMorphs(primitive, at);
    readSkin(at);
}

std::optional<Accessor> Vertices::ofColour(const std::string& name, Shape shape, Shape other) {
    try {
        const std::optional<size_t> index = wholeIn(attributes_, name.c_str());
        if (!index) return std::nullopt;
        const bool is_other = textIn(file_.at("accessors", *index), "type") == typeOf(other);
        Accessor out(file_, *index, is_other ? other : shape);
        if (out.count() >= count()) return out;
        file_.told.add(fmt::format("{} is ignored: it has too few elements", name));
    } catch (const Wrong& wrong) {
        file_.told.add(fmt::format("{} is ignored: {}", name, wrong.what()));
    }
    return std::nullopt;
}

void Vertices::readMorphs(const Json& primitive, const MeshNode& at) {
    const Json& targets = listIn(primitive, "targets");
    const Json& own = listIn(at.node, "weights");
    const Json& weights = own.is_null() ? listIn(at.mesh, "weights") : own;
    for (size_t i = 0; i < std::min(targets.size(), weights.size()); ++i) {
        if (!weights[i].is_number()) fail("weights holds something that is no number");
        const double weight = weights[i].get<double>();
        const std::optional<size_t> moved = wholeIn(targets[i], "POSITION");
        if (weight == 0 || !moved) continue;
        morphs_.emplace_back(weight, Accessor(file_, *moved, Shape::vec3));
        if (morphs_.back().second.count() < count())
            fail("a morph target has {} places of {} vertices", morphs_.back().second.count(), count());
    }
}

void Vertices::readSkin(const MeshNode& at) {
    const bool skinned = wholeIn(at.node, "skin").has_value();
    for (size_t set = 0; skinned && !joints_.empty(); ++set) {
        const std::string suffix = fmt::format("_{}", set);
        const std::optional<size_t> joints = wholeIn(attributes_, ("JOINTS" + suffix).c_str()),
                                    weights = wholeIn(attributes_, ("WEIGHTS" + suffix).c_str());
        if (!joints || !weights) break;
        influences_.push_back({Accessor(file_, *joints, Shape::vec4), Accessor(file_, *weights, Shape::vec4)});
        const Influence& last = influences_.back();
        if (!last.joints.isWhole()) fail("JOINTS{} that are no unsigned whole numbers", suffix);
        if (last.joints.count() < count() || last.weights.count() < count())
            fail("JOINTS{} or WEIGHTS{} have fewer elements than there are vertices", suffix, suffix);
    }
    ignores_skin_ = skinned && influences_.empty();
    if (ignores_skin_)
        file_.told.add("a skin that cannot be applied is ignored: the mesh is in its bind pose", 1, "primitive");
}

glm::dvec3 Vertices::place(size_t i, const glm::dmat4& world) const {
    glm::dvec3 place = places_.vec3(i);
    for (const auto& [weight, moved] : morphs_) place += weight * moved.vec3(i);
    glm::dvec3 sum(0);
    double weights = 0;
    for (const Influence& influence : influences_)
        for (size_t part = 0; part < 4; ++part) {
            const double weight = influence.weights.number(i, part);
            if (weight == 0) continue;
            const size_t joint = influence.joints.whole(i, part);
            if (joint >= joints_.size()) fail("vertex {} has joint {}; its skin has {}", i, joint, joints_.size());
            sum += weight * glm::dvec3(joints_[joint] * glm::dvec4(place, 1));
            weights += weight;
        }
    return weights != 0 ? sum / weights : glm::dvec3(world * glm::dvec4(place, 1));
}

glm::dvec4 Vertices::colour(size_t i) const {
    if (!colours_) return glm::dvec4(1);
    return {colours_->vec3(i), colours_->parts() == 4 ? colours_->number(i, 3) : 1};
}

bool Vertices::hasSet(size_t set) {
    coordinates_ = ofColour(fmt::format("TEXCOORD_{}", set), Shape::vec2, Shape::vec2);
    return coordinates_.has_value();
}

glm::dvec2 Vertices::coordinates(size_t i) const { return {coordinates_->number(i, 0), coordinates_->number(i, 1)}; }

} // namespace brume::gltf

// Materials: how triangles look, as far as one albedo a triangle can say it.
#pragma once

#include <map>
#include <optional>

#include <glm/glm.hpp>

#include "common/gltf/textures.h"

namespace brume::gltf {

struct Material {
    enum class Alpha { opaque, mask, blend };

    glm::vec4 factor{1}; // base colour: linear, alpha last
    Texture texture;     // texture of the base colour
    Alpha alpha = Alpha::opaque;
    float cutoff = 0.5f; // alpha of a mask, below which nothing is visible

    // Whether nothing is visible of what has this alpha.
    bool hides(float of) const;
};

class Materials {
public:
    explicit Materials(File& file) : file_(file), textures_(file) {}

    // Of a primitive. What it has that is not read is told.
    const Material& read(std::optional<size_t> index);

private:
    void tell(const Json& of, const Material& material);

    File& file_;
    Textures textures_;
    std::map<size_t, Material> materials_;
    Material plain_; // material of a primitive without one
};

} // namespace brume::gltf

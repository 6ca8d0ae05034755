#include "common/gltf/materials.h"

#include <algorithm>

#include <glm/gtc/type_ptr.hpp>

namespace brume::gltf {
namespace {

glm::vec4 factorOf(const Json& of, const char* key, const char* where, size_t index, Told& told) {
    glm::dvec4 factor(1);
    numbersIn(of, key, {glm::value_ptr(factor), 4});
    const glm::dvec4 allowed = glm::clamp(factor, 0.0, 1.0);
    if (allowed != factor) told.add(fmt::format("materials[{}] has a {} beyond 0 to 1, which is cut", index, where));
    return allowed;
}

} // namespace

bool Material::hides(float of) const {
    constexpr float kLeast = 0.5f / 255; // the least alpha that 8 bits show
    return (alpha == Alpha::mask && of < cutoff) || (alpha == Alpha::blend && of < kLeast);
}

const Material& Materials::read(std::optional<size_t> index) {
    if (!index) return plain_;
    const auto [found, fresh] = materials_.try_emplace(*index);
    Material& out = found->second;
    if (!fresh) return out;
    const Json& of = file_.at("materials", *index);
    const std::string mode = textIn(of, "alphaMode");
    out.alpha = mode == "MASK" ? Material::Alpha::mask : mode == "BLEND" ? Material::Alpha::blend : out.alpha;
    out.cutoff = float(std::clamp(numberIn(of, "alphaCutoff", double(out.cutoff)), 0.0, 2.0));
    const bool transparent = out.alpha != Material::Alpha::opaque;
    const Json &pbr = member(of, "pbrMetallicRoughness"),
               &glossy = extension(of, "KHR_materials_pbrSpecularGlossiness");
    if (!glossy.is_null()) {
        out.factor = factorOf(glossy, "diffuseFactor", "diffuse factor", *index, file_.told);
        out.texture = textures_.read(member(glossy, "diffuseTexture"), transparent);
    } else {
        out.factor = factorOf(pbr, "baseColorFactor", "base colour factor", *index, file_.told);
        out.texture = textures_.read(member(pbr, "baseColorTexture"), transparent);
    }
    tell(of, out);
    return out;
}

void Materials::tell(const Json& of, const Material& material) {
    if (material.texture.image) file_.told.add("textures are one colour a triangle", 1, "material");
    if (material.texture.image && material.alpha == Material::Alpha::mask)
        file_.told.add("alpha masks are one value a triangle", 1, "material");
    const Json& transmission = extension(of, "KHR_materials_transmission");
    if (!transmission.is_null() && numberIn(transmission, "transmissionFactor", 0) > 0)
        file_.told.add("transmission is ignored: what transmits light is opaque", 1, "material");
    const bool blended = material.alpha == Material::Alpha::blend;
    if (blended && (material.factor.a < 1 || material.texture.image))
        file_.told.add("blending is ignored: what has any alpha is opaque", 1, "material");
    glm::dvec3 emission(0);
    numbersIn(of, "emissiveFactor", {glm::value_ptr(emission), 3});
    if (emission != glm::dvec3(0)) file_.told.add("emission is ignored", 1, "material");
}

} // namespace brume::gltf

// Media and lights for the reference's tests.
#pragma once

#include <random>
#include <vector>

#include "tools/reference/world.h"

namespace brume::reference::test {

// `depth`: optical depth through the centre.
inline Blob blob(glm::dvec3 centre, double scale, double falloff, double depth, glm::dvec3 albedo = glm::dvec3(1)) {
    const double k = std::sqrt(50.0) / (scale * falloff);
    return {centre, scale, k, depth * k / kSqrtPi, depth / 2, albedo};
}

// Blobs of falloff 1.6 in a cube; scales and depths vary by a half about the given ones.
inline std::vector<Blob> cloud(int count, double extent, double scale, double depth, glm::dvec3 albedo) {
    std::mt19937 random(5);
    const auto unit = [&] { return random() / 4294967296.0 - 0.5; };
    std::vector<Blob> blobs;
    for (int i = 0; i < count; ++i) {
        const double x = unit(), y = unit(), z = unit(), size = unit(), thickness = unit();
        blobs.push_back(blob(extent * glm::dvec3(x, y, z), scale * (1 + size), 1.6, depth * (1 + thickness), albedo));
    }
    return blobs;
}

inline LightSource distant(glm::dvec3 to_light, double irradiance = 1) {
    LightSource light;
    light.to_light = glm::normalize(to_light);
    light.colour = glm::dvec3(irradiance);
    return light;
}

} // namespace brume::reference::test

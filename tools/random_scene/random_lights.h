// What random scenes of kind `lit` have besides: fogs, points and spots.
#pragma once

#include <span>

#include "common/random.h"
#include "common/scene.h"

namespace brume {

// What they are laid out by: the medium's points (m), which lie within about `radius` of the origin.
struct LitPlace {
    std::span<const glm::vec3> points;
    float radius; // m
};

// 0 to 2 fogs: homogeneous, thinning with height, layers and balls. Of optical depth 0.02 to 2 between the scene's
// camera and the medium, or across the medium where it is nearer.
void addRandomFogs(Scene& scene, const LitPlace& place, Random random);
// 0 to 6 points and spots in and near the medium. At half the medium's radius they light as the sun does, within a
// factor of 10.
void addRandomLights(Scene& scene, const LitPlace& place, Random random);

} // namespace brume

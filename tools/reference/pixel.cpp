#include "tools/reference/pixel.h"

#include <algorithm>

namespace brume::reference {
namespace {

constexpr float kSame = 0.01f; // of the larger of two radiances: below this they are the same

} // namespace

bool hasStructure(const World& world) {
    return std::ranges::any_of(world.obstacles, [](const Obstacle& obstacle) { return obstacle.structure > 0; });
}

bool isEdge(glm::vec3 centre, glm::vec3 mean, glm::vec3 corners) {
    const auto differs = [&](glm::vec3 other, float part) {
        return glm::any(glm::greaterThan(glm::abs(centre - other), part * glm::max(centre, other)));
    };
    return differs(mean, kSame) || differs(corners, 4 * kSame);
}

} // namespace brume::reference

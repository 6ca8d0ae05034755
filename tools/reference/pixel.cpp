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

PixelTracer::PixelTracer(const Stage& stage, const Camera& camera)
    : tracer_(stage), camera_(camera), objects_(hasEdges(stage.world)), structure_(hasStructure(stage.world)) {}

PixelResult PixelTracer::at(glm::uvec2 pixel) {
    const auto at = [&](double x, double y, bool even) {
        Ray ray = rayThrough(camera_, pixel.x + x, pixel.y + y);
        ray.even = even;
        return tracer_.trace(ray);
    };
    return pixelOf(at, objects_, structure_);
}

} // namespace brume::reference

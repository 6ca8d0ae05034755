#include "tools/random_scene/random_cameras.h"

#include "tools/random_scene/random_layout.h"

namespace brume {
namespace {

constexpr const char* kNames[] = {"outside", "inside", "grazing", "far"};

glm::vec3 across(glm::vec3 direction, Random& random) { // a unit vector at a right angle
    for (;;) {
        const glm::vec3 side = glm::cross(direction, random.direction());
        if (glm::dot(side, side) > 1e-2f) return glm::normalize(side);
    }
}

} // namespace

std::span<const char* const> randomCameras() { return kNames; }

std::string placeRandomCamera(SceneCamera& camera, std::span<const glm::vec3> points, float radius, Random& random) {
    const uint64_t kind = random.bits() % std::size(kNames);
    const glm::vec3 away = random.direction(), side = across(away, random);
    const glm::vec3 point = points[random.bits() % points.size()];
    camera.fov_y = random.uniform(0.4f, 1.2f);
    camera.target = 0.3f * point;
    switch (kind) {
    case 0:
        camera.position = radius * random.uniform(1.5f, 3.5f) * away;
        break;
    case 1: // at a point, looking across the medium
        camera.position = point + 0.05f * radius * away;
        camera.target = camera.position + glm::normalize(side - 0.5f * glm::normalize(point + 0.01f * away)) * radius;
        break;
    case 2: // beside a point on the rim, along it
        camera.position = point + 0.2f * radius * away - 0.5f * radius * side;
        camera.target = point + radius * side;
        break;
    default:
        camera.position = radius * logUniform(random, 8, 60) * away;
        break;
    }
    return kNames[kind];
}

} // namespace brume

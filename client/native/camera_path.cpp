#include "client/native/camera_path.h"

#include <cmath>
#include <numbers>

namespace brume::client {
namespace {

constexpr double kLookAhead = 0.6; // rad of the figure eight
constexpr float kWalked = 0.12f;   // radius of a walk, of the start's distance from the target
constexpr double kLookAbout = 0.6; // rad, to both sides

constexpr struct {
    PathKind kind;
    std::string_view name;
    double seconds;
} kPaths[]{{PathKind::still, "still", kOrbitSeconds},
           {PathKind::orbit, "orbit", kOrbitSeconds},
           {PathKind::fly, "fly", kFlySeconds},
           {PathKind::walk, "walk", kWalkSeconds},
           {PathKind::keys, "keys", kOrbitSeconds}};

glm::vec3 aroundY(glm::vec3 v, double angle) {
    const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

} // namespace

Pose CameraPath::at(double seconds) const {
    if (kind == PathKind::keys && keys) return poseOf(keys->at(seconds));
    const glm::vec3 away = position - target;
    if (kind == PathKind::orbit)
        return lookAt(target + aroundY(away, 2 * std::numbers::pi * seconds / kOrbitSeconds), target, fov_y);
    if (kind == PathKind::fly) {
        // A lemniscate whose long axis is the start's; it begins at the start, the far end of the eight.
        const glm::vec3 side = 0.5f * aroundY(away, std::numbers::pi / 2);
        const auto on_eight = [&](double angle) {
            return target + static_cast<float>(std::cos(angle)) * away + static_cast<float>(std::sin(2 * angle)) * side;
        };
        const double angle = 2 * std::numbers::pi * seconds / kFlySeconds;
        return lookAt(on_eight(angle), on_eight(angle + kLookAhead), fov_y);
    }
    if (kind == PathKind::walk) {
        const double angle = 2 * std::numbers::pi * seconds / kWalkSeconds;
        const glm::vec3 off = kWalked * aroundY({glm::length(away), 0, 0}, angle);
        const glm::vec3 here = position + off;
        return lookAt(here, here - aroundY(away, kLookAbout * std::sin(2 * angle)), fov_y);
    }
    return lookAt(position, target, fov_y);
}

std::optional<PathKind> pathNamed(std::string_view name) {
    for (const auto& path : kPaths)
        if (path.name == name) return path.kind;
    return {};
}

std::string_view nameOf(PathKind kind) { return kPaths[size_t(kind)].name; }

double secondsOf(PathKind kind) { return kPaths[size_t(kind)].seconds; }

Ray cursorRay(const Pose& pose, float x, float y, float aspect) {
    const float tangent = std::tan(0.5f * pose.fov_y);
    const glm::vec3 view((2 * x - 1) * tangent * aspect, (1 - 2 * y) * tangent, -1);
    return {pose.position, glm::normalize(pose.orientation * view)};
}

} // namespace brume::client

// Cameras that move along a path, and the ray through a cursor.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "common/camera_keys.h"

namespace brume::client {

inline constexpr double kOrbitSeconds = 20, kFlySeconds = 40, kWalkSeconds = 30; // one round of the path

enum class PathKind {
    still,
    orbit, // a circle around the target, at the height of the start
    fly,   // a figure eight through the target, looking along the path
    walk,  // a small circle around the start, at its height, looking about: where the start is inside, it stays there
    keys,  // through key views: a scene's own, or those of a file
};

struct CameraPath {
    PathKind kind = PathKind::still;
    glm::vec3 position{0, 2, 26}, target{0}; // m; the start, and what it moves about; never equal
    float fov_y = 0.8f;
    std::shared_ptr<const KeyPath> keys = {}; // the path of kind keys; null: the camera is still

    // A pure function of the time since the start, in seconds.
    Pose at(double seconds) const;
};

std::optional<PathKind> pathNamed(std::string_view name);
std::string_view nameOf(PathKind kind);
double secondsOf(PathKind kind); // duration of one round, s; of keys that of an orbit

struct Ray {
    glm::vec3 origin{0}, direction{0, 0, -1}; // direction is unit
    bool operator==(const Ray&) const = default;
};

// The ray through a point of the picture; x and y in [0, 1], from the left and the top. Aspect = width / height.
Ray cursorRay(const Pose& pose, float x, float y, float aspect);

} // namespace brume::client

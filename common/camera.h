// Cameras: where a viewer stands and how it projects. Metres, radians, right-handed, +Y up; a camera looks down its own -Z.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace brume {

struct Pose {
    glm::vec3 position{0, 0, 10};
    glm::quat orientation{1, 0, 0, 0}; // world from view, unit length (w, x, y, z)
    float fov_y = 0.8f;                // full vertical angle, in (0, pi)
    float eye_separation = 0;          // between the two eyes of a stereo viewer; 0 for one eye
};

// The pose that stands at `position` and sees `target` in the middle of its picture, +Y up.
// Precondition: the two differ. Looking straight up or down takes +Z as the picture's up or down.
Pose lookAt(glm::vec3 position, glm::vec3 target, float fov_y);

// The pose of one eye: 0 left, 1 right, of `views`; a single view is the pose itself.
Pose eyePose(const Pose& head, int eye, int views);

// True when every number is finite, the orientation is a unit quaternion within 1e-2 and fov_y is in (0.01, 3.1).
bool isUsable(const Pose& pose);

} // namespace brume

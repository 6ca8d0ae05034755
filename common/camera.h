// Cameras: position and projection of a viewer. Metres, radians, right-handed, +Y up; a camera looks along its own -Z.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace brume {

// The field of view: tangents of the angles from the view axis to the picture's sides, positive toward the named
// side. Opposite sides may lie on the same side of the axis, but left + right and up + down are positive.
struct Frustum {
    float left = 0, right = 0, up = 0, down = 0;
    bool operator==(const Frustum&) const = default;
};

struct Pose {
    glm::vec3 position{0, 0, 10};
    glm::quat orientation{1, 0, 0, 0}; // world from view, unit length (w, x, y, z)
    float fov_y = 0.8f;                // full vertical angle, in (0, pi)
    float eye_separation = 0;          // m between the two eyes of a stereo viewer; 0 for one eye
    Frustum frustum;                   // of the only or left eye, replaces fov_y; all 0: symmetric by fov_y
    Frustum right_frustum;             // of the right eye of two
};

// The pose at `position` with `target` in the middle of its picture, +Y up.
// Precondition: the two differ. Looking straight up or down takes +Z as the picture's up or down.
Pose lookAt(glm::vec3 position, glm::vec3 target, float fov_y);

// The pose of one eye: 0 left, 1 right, of `views`; a single view is the pose itself.
Pose eyePose(const Pose& head, int eye, int views);

// The field of view of one eye's picture with square pixels: from fov_y, or the pose's own frustum. A frustum of
// another shape than the picture is widened in one direction about its middle.
Frustum frustumOf(const Pose& eye, uint32_t width, uint32_t height);

// Distance from the eye to the farthest corner of the field of view at unit view depth.
float cornerLength(const Frustum& frustum);

// True if all tangents are 0, or all are in -50 ... 50 and left + right and up + down are at least 0.01.
bool isUsable(const Frustum& frustum);

// True if all numbers are finite (frusta are not checked), the orientation is a unit quaternion within 1e-2, fov_y is
// in (0.01, 3.1), and the eye separation is in limits::kEyeSeparation.
bool isUsable(const Pose& pose);

} // namespace brume

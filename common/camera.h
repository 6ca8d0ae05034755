// Cameras: where a viewer stands and how it projects. Metres, radians, right-handed, +Y up; a camera looks down its own -Z.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace brume {

// What a picture covers: tangents of the angles from the view axis to its sides, positive toward the side that is named. Opposite
// sides may both lie on one side of the axis, but left + right and up + down are positive.
struct Frustum {
    float left = 0, right = 0, up = 0, down = 0;
    bool operator==(const Frustum&) const = default;
};

struct Pose {
    glm::vec3 position{0, 0, 10};
    glm::quat orientation{1, 0, 0, 0}; // world from view, unit length (w, x, y, z)
    float fov_y = 0.8f;                // full vertical angle, in (0, pi)
    float eye_separation = 0;          // between the two eyes of a stereo viewer; 0 for one eye
    Frustum frustum;                   // of the one or left eye, instead of fov_y; all 0: symmetric
    Frustum right_frustum;             // of the right eye of two
};

// The pose that stands at `position` and sees `target` in the middle of its picture, +Y up.
// Precondition: the two differ. Looking straight up or down takes +Z as the picture's up or down.
Pose lookAt(glm::vec3 position, glm::vec3 target, float fov_y);

// The pose of one eye: 0 left, 1 right, of `views`; a single view is the pose itself.
Pose eyePose(const Pose& head, int eye, int views);

// What the picture of one eye covers, its pixels square: by fov_y, or the pose's own frustum, widened in one direction about its
// middle where it has another shape than the picture.
Frustum frustumOf(const Pose& eye, uint32_t width, uint32_t height);

// Distance of the farthest corner of what is seen at unit view depth.
float cornerLength(const Frustum& frustum);

// True when all of it is 0, or tangents are in -50 ... 50 and left + right and up + down at least 0.01.
bool isUsable(const Frustum& frustum);

// True when every number but those of frusta is finite, the orientation is a unit quaternion within 1e-2, fov_y is in
// (0.01, 3.1) and the eyes are apart by what limits::kEyeSeparation holds.
bool isUsable(const Pose& pose);

} // namespace brume

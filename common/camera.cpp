#include "common/camera.h"

#include <cmath>

namespace brume {

Pose lookAt(glm::vec3 position, glm::vec3 target, float fov_y) {
    const glm::vec3 back = glm::normalize(position - target);
    const glm::vec3 up = std::abs(back.y) > 0.9999f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::vec3 right = glm::normalize(glm::cross(up, back));
    const glm::mat3 world_from_view(right, glm::cross(back, right), back);
    Pose pose;
    pose.position = position;
    pose.orientation = glm::normalize(glm::quat_cast(world_from_view));
    pose.fov_y = fov_y;
    return pose;
}

Pose eyePose(const Pose& head, int eye, int views) {
    Pose pose = head;
    pose.eye_separation = 0;
    if (views > 1) {
        const float side = eye == 0 ? -0.5f : 0.5f;
        pose.position += head.orientation * glm::vec3(side * head.eye_separation, 0, 0);
    }
    return pose;
}

bool isUsable(const Pose& pose) {
    const auto finite = [](float x) { return std::isfinite(x) && std::abs(x) < 1e7f; };
    const glm::vec3& p = pose.position;
    const glm::quat& q = pose.orientation;
    if (!finite(p.x) || !finite(p.y) || !finite(p.z)) return false;
    if (!finite(q.x) || !finite(q.y) || !finite(q.z) || !finite(q.w)) return false;
    const float length = std::sqrt(glm::dot(q, q));
    if (!(std::abs(length - 1) < 1e-2f)) return false;
    return pose.fov_y > 0.01f && pose.fov_y < 3.1f && pose.eye_separation >= 0 && pose.eye_separation < 1.0f;
}

} // namespace brume

#include "common/camera.h"

#include <algorithm>
#include <cmath>

#include "common/scene_limits.h"

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
    pose.right_frustum = {};
    if (views > 1) {
        if (eye == 1) pose.frustum = head.right_frustum;
        const float side = eye == 0 ? -0.5f : 0.5f;
        pose.position += head.orientation * glm::vec3(side * head.eye_separation, 0, 0);
    }
    return pose;
}

Frustum frustumOf(const Pose& eye, uint32_t width, uint32_t height) {
    const auto w = float(width), h = float(height);
    if (eye.frustum == Frustum{}) {
        const float tan_y = std::tan(0.5f * eye.fov_y), tan_x = tan_y * w / h;
        return {tan_x, tan_x, tan_y, tan_y};
    }
    Frustum f = eye.frustum;
    const float pixel = std::max((f.left + f.right) / w, (f.up + f.down) / h);
    const float wider = 0.5f * std::max(pixel * w - (f.left + f.right), 0.0f);
    const float higher = 0.5f * std::max(pixel * h - (f.up + f.down), 0.0f);
    return {f.left + wider, f.right + wider, f.up + higher, f.down + higher};
}

float cornerLength(const Frustum& f) {
    const float x = std::max(std::abs(f.left), std::abs(f.right)), y = std::max(std::abs(f.up), std::abs(f.down));
    return std::sqrt(1 + x * x + y * y);
}

bool isUsable(const Frustum& f) {
    constexpr float kMost = 50, kLeast = 0.01f;
    if (f == Frustum{}) return true;
    for (const float tangent : {f.left, f.right, f.up, f.down})
        if (!(std::abs(tangent) <= kMost)) return false;
    return f.left + f.right >= kLeast && f.up + f.down >= kLeast;
}

bool isUsable(const Pose& pose) {
    const auto finite = [](float x) { return std::isfinite(x) && std::abs(x) < 1e7f; };
    const glm::vec3& p = pose.position;
    const glm::quat& q = pose.orientation;
    if (!finite(p.x) || !finite(p.y) || !finite(p.z)) return false;
    if (!finite(q.x) || !finite(q.y) || !finite(q.z) || !finite(q.w)) return false;
    const float length = std::sqrt(glm::dot(q, q));
    if (!(std::abs(length - 1) < 1e-2f)) return false;
    return pose.fov_y > 0.01f && pose.fov_y < 3.1f && limits::kEyeSeparation.holds(double(pose.eye_separation));
}

} // namespace brume

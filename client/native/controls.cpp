#include "client/native/controls.h"

#include <algorithm>
#include <cmath>

namespace brume::client {
namespace {

constexpr float kMaxPitch = 1.55f;                         // rad, just short of straight up or down
constexpr float kMinDistance = 0.05f, kMaxDistance = 1e5f; // m
constexpr float kMinSpeed = 0.1f, kMaxSpeed = 1000;        // m/s
constexpr float kWheelStep = 1.1f;

glm::quat turned(float yaw, float pitch) {
    return glm::angleAxis(yaw, glm::vec3(0, 1, 0)) * glm::angleAxis(pitch, glm::vec3(1, 0, 0));
}

} // namespace

Controls::Controls(glm::vec3 position, glm::vec3 target, float fov_y) : position_(position), fov_y_(fov_y) {
    const glm::vec3 to_target = target - position;
    distance_ = std::clamp(glm::length(to_target), kMinDistance, kMaxDistance);
    lookAlong(to_target);
    speed_ = std::clamp(distance_ / 4, kMinSpeed, kMaxSpeed);
}

glm::vec3 Controls::ahead() const { return turned(yaw_, pitch_) * glm::vec3(0, 0, -1); }

void Controls::lookAlong(glm::vec3 direction) {
    yaw_ = std::atan2(-direction.x, -direction.z);
    pitch_ = std::clamp(std::atan2(direction.y, std::hypot(direction.x, direction.z)), -kMaxPitch, kMaxPitch);
}

void Controls::standAt(const Pose& pose) {
    position_ = pose.position;
    lookAlong(pose.orientation * glm::vec3(0, 0, -1));
}

void Controls::toggleFly() { flying_ = !flying_; }

void Controls::turn(float yaw, float pitch) {
    const glm::vec3 target = position_ + distance_ * ahead();
    yaw_ = std::remainder(yaw_ - yaw, 2 * 3.14159265f);
    pitch_ = std::clamp(pitch_ + pitch, -kMaxPitch, kMaxPitch);
    if (!flying_) position_ = target - distance_ * ahead();
}

void Controls::wheel(float steps) {
    if (flying_) {
        speed_ = std::clamp(speed_ * std::pow(kWheelStep, steps), kMinSpeed, kMaxSpeed);
        return;
    }
    const glm::vec3 target = position_ + distance_ * ahead();
    distance_ = std::clamp(distance_ * std::pow(kWheelStep, -steps), kMinDistance, kMaxDistance);
    position_ = target - distance_ * ahead();
}

void Controls::move(glm::vec3 direction, float seconds) {
    const glm::vec3 view(direction.x, direction.y, -direction.z);
    position_ += turned(yaw_, pitch_) * view * (speed_ * seconds);
}

Pose Controls::pose() const {
    Pose pose;
    pose.position = position_;
    pose.orientation = turned(yaw_, pitch_);
    pose.fov_y = fov_y_;
    return pose;
}

} // namespace brume::client

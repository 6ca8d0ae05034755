#include "client/load/pusher.h"

#include <algorithm>

namespace brume::load {
namespace {

constexpr float kNear = 0.1f; // rays pass the centre within this part of the distance from the path's start to it
constexpr float kGentle = 0.5f, kStrong = 1.5f; // Impulse::strength

} // namespace

Pusher::Pusher(double rate, uint64_t seed, double phase)
    : period_us_(rate > 0 ? std::max<uint64_t>(uint64_t(1e6 / rate), 1) : kNever), phase_(phase),
      next_us_(rate > 0 ? 0 : kNever), random_(seed) {}

std::optional<client::Impulse> Pusher::due(uint64_t now_us, glm::vec3 camera, const client::CameraPath& path) {
    if (now_us < next_us_ || period_us_ == kNever) return {};
    if (next_us_ == 0) { // viewers push one after another, not all at once
        next_us_ = now_us + 1 + uint64_t(phase_ * double(period_us_));
        return {};
    }
    // So many a second on average, without catching up on a time in which this program did not run.
    next_us_ = std::max(next_us_ + period_us_, now_us + period_us_ / 2);
    const float radius = kNear * glm::length(path.position - path.target);
    glm::vec3 goal = path.target;
    for (int axis = 0; axis < 3; ++axis) goal[axis] += between(-radius, radius);
    const float strength = between(kGentle, kStrong);
    const glm::vec3 way = goal - camera;
    const float length = glm::length(way);
    return client::Impulse{camera, length > 1e-3f ? way / length : glm::vec3(0, 0, -1), glm::vec3(0), strength};
}

// The library's own distributions differ between implementations.
float Pusher::between(float low, float high) { return low + (high - low) * float(double(random_() >> 11) * 0x1p-53); }

} // namespace brume::load

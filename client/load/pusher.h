// Pushes that a viewer makes: at an even rate, where its seed says.
#pragma once

#include <cstdint>
#include <optional>
#include <random>

#include "client/native/camera_path.h"
#include "client/native/session.h"

namespace brume::load {

class Pusher {
public:
    // `rate`: pushes a second; 0: none. `phase`: where in the interval the first one is, in [0, 1). The same seed and
    // cameras give the same pushes.
    Pusher(double rate, uint64_t seed, double phase);

    static constexpr uint64_t kNever = UINT64_MAX;
    // When the next push is due, in client::nowUs(); kNever: none is. Before the first call of due() it is 0.
    uint64_t nextUs() const { return next_us_; }
    // The push that is due. It goes from the camera along a ray near the centre of what its path is about.
    std::optional<client::Impulse> due(uint64_t now_us, glm::vec3 camera, const client::CameraPath& path);

private:
    float between(float low, float high);

    uint64_t period_us_;
    double phase_;
    uint64_t next_us_;
    std::mt19937_64 random_;
};

} // namespace brume::load

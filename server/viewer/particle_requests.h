// Wishes of operators for the particles as they are. The frame loop answers them between two ticks.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "server/viewer/requests.h"
#include "shaders/shared/types.h"

namespace brume {

struct TakenParticles {
    std::string scene;
    uint64_t tick = 0, state_hash = 0;
    uint64_t first = 0;   // id of the first particle; those behind it count on
    glm::dvec3 origin{0}; // m, that places count from
    float falloff = 1;
    std::vector<gpu::Particle> particles;
    std::vector<gpu::EllipsoidAxes> axes; // of each; empty: they are balls
};

class ParticleRequest {
public:
    // `notify`: called once by the thread that answers.
    explicit ParticleRequest(std::function<void()> notify) : notify_(std::move(notify)) {}

    void answer(TakenParticles taken) {
        taken_ = std::move(taken);
        answered_ = true;
        notify_();
    }
    bool answered() const { return answered_; }
    // Precondition: answered().
    const TakenParticles& taken() const { return taken_; }

private:
    const std::function<void()> notify_;
    TakenParticles taken_;
    std::atomic<bool> answered_{false};
};

using ParticleRequests = Requests<ParticleRequest>;

} // namespace brume

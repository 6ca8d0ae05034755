// Painter: who draws the medium from lit particles, for viewers who do that by themselves.
#pragma once

#include <cstdint>

#include "client/native/jpeg.h"
#include "common/camera.h"
#include "protocol/lit_particles.h"
#include "protocol/message.h"

namespace brume::client {

class Painter {
public:
    virtual ~Painter() = default;
    // The particles from now on. `rows`: of the message, as LitReader gives them. Both functions throw
    // std::runtime_error, one line.
    virtual void take(const wire::LitParticles& message, const lit::Rows& rows) = 0;
    // Draws what `eye` sees. Precondition: particles were taken.
    virtual void draw(const Pose& eye, uint32_t width, uint32_t height, Picture& out) = 0;
};

} // namespace brume::client

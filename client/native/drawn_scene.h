// DrawnScene: draws the medium from lit particles with the server's own renderer, on this machine's Vulkan device. The
// renderer lights the particles anew, as the server does for pictures: the light of the message is for other programs.
#pragma once

#include <memory>

#include "client/native/painter.h"
#include "common/scene.h"

namespace brume::client {

// The scene that a message tells, with room for `count` particles, without any.
Scene sceneOf(const wire::LitParticles& message, uint32_t count);

class DrawnScene final : public Painter {
public:
    // Throws std::runtime_error, one line, without a Vulkan device that can draw.
    DrawnScene();
    ~DrawnScene() override;

    void take(const wire::LitParticles& message, const lit::Rows& rows) override;
    // Waits for the device.
    void draw(const Pose& eye, uint32_t width, uint32_t height, Picture& out) override;

    const std::string& device() const; // its name

private:
    struct Stage;
    std::unique_ptr<Stage> stage_;
};

} // namespace brume::client

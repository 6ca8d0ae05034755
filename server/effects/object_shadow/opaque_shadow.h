// Opaque shadow map: how high along to_light the topmost box or sphere is, seen from the light; -1e30 where there is
// none.
#pragma once

#include <span>

#include "server/gpu/commands.h"
#include "server/gpu/program.h"
#include "shaders/shared/types.h"

namespace brume {

class OpaqueShadow {
public:
    explicit OpaqueShadow(const gpu::Device& device);

    // Records the map. `shared`: TickBlock and Objects, which holds `objects`. Its writes are then visible to compute
    // and draws. Makes a new image if the size changed; precondition: the device does not use the old one.
    void record(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick,
                std::span<const gpu::Opaque> objects);

    const gpu::Image& image() const { return image_; }

private:
    const gpu::Device& device_;
    gpu::GraphicsProgram program_;
    gpu::Image image_;
};

} // namespace brume

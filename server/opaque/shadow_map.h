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

    // Records the map unless light and size are those of the last time. `shared`: TickBlock and Objects, which holds
    // `objects`. As ShadowVolume::record otherwise.
    bool record(gpu::Commands& commands, const gpu::Resources& shared, const gpu::Tick& tick,
                std::span<const gpu::Opaque> objects);

    // The objects are others than the last time.
    void invalidate() { valid_ = false; }

    const gpu::Image& image() const { return image_; }

private:
    const gpu::Device& device_;
    gpu::GraphicsProgram program_;
    gpu::Image image_;
    gpu::Tick last_{};
    bool valid_ = false; // True: the image is of the objects as they are
};

} // namespace brume

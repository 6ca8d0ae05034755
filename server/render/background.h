// Per eye, first: the sky and the opaque objects, with the shadows that objects and medium throw on them.
#pragma once

#include "server/render/method.h"

namespace brume {

class Background {
public:
    // Compiled for the scene's objects: those that it has none of cost nothing. CPU drivers draw several times faster into
    // targets than they store to images; on some GPUs compute is far faster than draws.
    Background(const gpu::Device& device, const Scene& scene) : Background(device, scene, device.isCpu()) {}
    Background(const gpu::Device& device, const Scene& scene, bool by_draw);

    // Writes all of EyeInputs::radiance, transmittance 1, and EyeInputs::view_depth; both may be read and written by anything
    // after it.
    void record(gpu::Commands& commands, const EyeInputs& in) const;

private:
    gpu::GraphicsProgram draw_; // or
    gpu::ComputeProgram compute_;
};

} // namespace brume

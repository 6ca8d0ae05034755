// Per eye, or once for a head's two: cull, then the far-to-near order of what is left, and the indirect arguments to draw it.
// Scratch, used eye after eye.
#pragma once

#include "server/render/method.h"
#include "server/render/sort.h"

namespace brume {

class DepthOrder {
public:
    DepthOrder(const gpu::Device& device, uint32_t capacity);

    enum class Support { tetrahedron, sphere };
    // After it, order() and arguments() may be read by draws: instance i is the i-th farthest particle that the eye, or the
    // other one of its head, can see. For an eye that is ordered with the one before: nothing, that one's order holds.
    void record(gpu::Commands& commands, const EyeInputs& inputs, Support support, uint32_t vertices,
                uint32_t particles_per_group);

    const gpu::Buffer& order() const { return values_; }
    const gpu::Buffer& arguments() const { return arguments_; }

private:
    gpu::ComputeProgram cull_, draw_arguments_;
    RadixSort sort_;
    gpu::Buffer keys_, values_, arguments_;
};

} // namespace brume

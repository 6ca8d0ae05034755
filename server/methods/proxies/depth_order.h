// Far-to-near order of the particles that an eye can see, or the two eyes of a head together: cull, sort, and the
// indirect arguments to draw what is left. Eyes use the same buffers one after the other.
#pragma once

#include "server/gpu/program.h"
#include "server/inputs/eye_inputs.h"
#include "server/methods/proxies/sort.h"

namespace brume {

class FurthestDepths;

class DepthOrder {
public:
    DepthOrder(const gpu::Device& device, uint32_t capacity);

    // What a particle is drawn within: its tetrahedron, the same filled evenly, the sphere around its Gaussian, or a
    // picture of its ball.
    enum class Support { tetrahedron, even_tetrahedron, sphere, sprite };
    // Afterwards draws may read order() and arguments(): instance i is the i-th farthest particle that the eye, or the
    // other one of its head, can see. Records nothing for an eye whose order is ready. With `furthest`
    // particles that objects hide are left out, unless another eye or picture uses the same order. Precondition then:
    // surfaces are drawn.
    void record(gpu::Commands& commands, const EyeInputs& in, Support support, uint32_t vertices,
                uint32_t particles_per_group, const FurthestDepths* furthest = nullptr);

    const gpu::Buffer& order() const { return values_; }
    const gpu::Buffer& arguments() const { return arguments_; }

private:
    const gpu::Device& device_;
    gpu::ComputeProgram cull_, draw_arguments_;
    gpu::ComputeProgram cull_hidden_; // made when it is first needed
    RadixSort sort_;
    gpu::Buffer keys_, values_, arguments_;
};

} // namespace brume

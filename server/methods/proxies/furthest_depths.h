// How far the surfaces of an eye's picture are at most, in each tile of 16x16 pixels: particles behind that are hidden.
// Eyes use the same buffer one after the other.
#pragma once

#include <span>

#include "server/gpu/commands.h"
#include "server/gpu/program.h"
#include "server/inputs/eye_inputs.h"

namespace brume {

class FurthestDepths {
public:
    explicit FurthestDepths(const gpu::Device& device);

    // Makes room. Precondition: nothing on the device uses it.
    void prepare(std::span<const EyeInputs> eyes);
    // Ends with its writes visible to compute. Precondition: surfaces are drawn, and earlier reads are done.
    void record(gpu::Commands& commands, const EyeInputs& in) const;
    // m, row by row.
    const gpu::Buffer& buffer() const { return buffer_; }

private:
    const gpu::Device& device_;
    gpu::ComputeProgram program_;
    gpu::Buffer buffer_;
};

} // namespace brume

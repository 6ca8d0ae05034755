// Per eye of a scene with opaque objects: the medium drawn at every step-th pixel alone becomes that of the pixels between, but
// where surfaces or shafts of shadow make it change sharply.
#pragma once

#include <map>

#include "server/render/method.h"

namespace brume {

class DrawnCells {
public:
    explicit DrawnCells(const gpu::Device& device) : device_(device) {}

    // Before the medium is drawn at EyeInputs::nodes: nothing is in its radiance, the surfaces are in its view depth.
    void begin(gpu::Commands& commands, const EyeInputs& nodes) const;
    // Afterwards: puts it over the background of the pixels that a cubic between nodes can tell, and makes their view depth 0, so
    // that the method adds nothing more to them.
    void record(gpu::Commands& commands, const EyeInputs& in);

private:
    const gpu::Device& device_;
    std::map<uint32_t, gpu::ComputeProgram> programs_; // by the step
};

} // namespace brume

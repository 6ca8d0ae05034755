// For scenes with opaque objects: the medium drawn at every step-th pixel only becomes that of the pixels between,
// except in cells that the edge of a surface or of its shadow crosses.
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "server/inputs/eye_inputs.h"

namespace brume {

class DrawnCells {
public:
    explicit DrawnCells(const gpu::Device& device);

    // Before the medium is drawn at every step-th pixel: leaves the surfaces in that target's view depth, and no
    // radiance.
    void clear(gpu::Commands& commands, const EyeInputs& coarse) const;
    // Afterwards: interpolates it, over the background that the fine target holds. Pixels that are done get the view
    // depth 0, so that a method which then draws all pixels adds nothing to them.
    void interpolate(gpu::Commands& commands, const EyeInputs& fine, const EyeInputs& coarse);

private:
    gpu::Variants program_;
};

} // namespace brume

// GlassLayers: pictures through sheets of glass as sums of layers of the medium (shaders/shared/glass.h). The medium is
// drawn before surfaces, and once more for each layer, up to the nearest sheet of each pixel, to the second one, and so
// on.
#pragma once

#include <span>
#include <vector>

#include "server/gpu/variants.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/view_group.h"

namespace brume {

class GlassLayers {
public:
    GlassLayers(const gpu::Device& device, std::span<const Glass> glasses);

    // Makes room for pictures of these sizes; none: there is no glass. Precondition: nothing of it is on the device.
    void prepare(std::span<const EyeRequest> eyes);
    // Layers of the eye's picture besides the whole medium.
    uint32_t layersOf(const EyeInputs& in) const;
    // Adds to the group's pixels what the target holds. `drawn` counts up from 0: the whole medium before surfaces,
    // then the layers. After the last one the target holds the picture, and the depths of surfaces; before, it is set
    // up for the next layer: black, with the depths where that ends. Ends with its writes visible to all.
    void record(gpu::Commands& commands, const ViewGroup& group, uint32_t drawn, uint32_t layers);

    static constexpr uint64_t kBytesOfPixel = 5 * sizeof(float);
    // Bytes that pictures take.
    uint64_t pictureBytes() const { return sums_.size(); }
    void giveBack() { sums_ = {}; }

private:
    const gpu::Device& device_;
    const std::vector<Glass> glasses_;
    gpu::Variants program_;
    gpu::Buffer sheets_; // gpu::GlassSheet[]
    gpu::Buffer sums_;   // GlassSum[row][column] of shaders/glass.comp
};

} // namespace brume

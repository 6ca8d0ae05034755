// DepthLayers: pictures of a view's layers with depth, from which viewers redraw it when their eye has moved
// (shaders/shared/depth_layers.h). Of methods with a field of rays; of others and of fog there are no layers, and all
// moves with the surfaces. What no eye asks for costs nothing.
#pragma once

#include <span>
#include <vector>

#include "server/encode/depth_layers.h"
#include "server/gpu/variants.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/view_group.h"

namespace brume {

class DepthLayers {
public:
    explicit DepthLayers(const gpu::Device& device);

    // Says where an eye's layers begin: `at` bytes into Planes. `surfaces`: true if there are any.
    static void place(const EyeRequest& eye, bool surfaces, VkDeviceSize at, gpu::DepthLayers& layers);
    // What of `planes`, the bytes of Planes, they are. `view`: as its group has it, or as it was placed without one.
    static DepthLayersView viewOf(const gpu::View& view, const uint8_t* planes);

    // To be called after the group was composed, and before another one is drawn.
    void record(gpu::Commands& commands, const ViewGroup& group);

private:
    gpu::Variants layers_;
    gpu::ComputeProgram surface_;
};

} // namespace brume

// Shafts: the part of the sun's light in the medium before each pixel of one eye that objects do not shadow.
#pragma once

#include <span>

#include "server/gpu/binding_sizes.h"
#include "server/gpu/variants.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/view_group.h"

namespace brume {

class Shafts {
public:
    explicit Shafts(const gpu::Device& device);

    // Makes room for pictures of these sizes; none: nothing throws a shadow on the medium. Precondition: nothing of it
    // is on the device.
    void prepare(std::span<const EyeRequest> eyes);
    // Precondition: the group has a field. Ends with its writes visible to compute.
    void record(gpu::Commands& commands, const ViewGroup& group);

    static constexpr uint64_t kBytesOfPixel = 3 * sizeof(float);
    // Bytes that pictures take.
    uint64_t pictureBytes() const { return sunlit_.size() > gpu::kLeastBinding ? sunlit_.size() : 0; }
    const gpu::Buffer& sunlit() const { return sunlit_; } // vec3[rows][columns] of the last eye's pixels, 0 ... 1
    void giveBack();

private:
    const gpu::Device& device_;
    gpu::Variants program_;
    gpu::Buffer sunlit_;
};

} // namespace brume

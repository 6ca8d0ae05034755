// LocalLights: what points and spots add to one eye's picture. First the bins of pixels that each may reach, which the
// surfaces' shading reads as well; then, with the medium's field, the light that it scatters toward the eye.
#pragma once

#include <span>
#include <vector>

#include "server/gpu/binding_sizes.h"
#include "server/gpu/variants.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/view_group.h"

namespace brume {

class LocalLights {
public:
    explicit LocalLights(const gpu::Device& device);

    // Makes room for pictures of these sizes, which may have no lights, so many lights, and `volumes` numbers of the
    // particles' depth.
    // Precondition: nothing of it is on the device.
    void prepare(std::span<const EyeRequest> eyes, uint32_t lights, uint32_t volumes);
    // The volumes, unless particles and lights are those of the last call. Ends with its writes visible to all.
    void recordDepths(gpu::Commands& commands, const MediumView& medium, std::span<const gpu::LocalLight> lights);
    // Of the eye whose surfaces are drawn next. Ends with its writes visible to compute and fragments.
    void recordBins(gpu::Commands& commands, const EyeInputs& in);
    // Precondition: the group has a field, and its eye's bins are recorded. Ends with its writes visible to compute.
    void record(gpu::Commands& commands, const ViewGroup& group);

    static constexpr uint64_t kBytesOfPixel = 3 * sizeof(float);
    static constexpr uint64_t kMostBytesOfBins = 1; // bytes for each pixel: 256 share a bin of at most 32 words
    // Bytes that pictures take.
    uint64_t pictureBytes() const {
        const auto taken = [](const gpu::Buffer& buffer) {
            return buffer.size() > gpu::kLeastBinding ? buffer.size() : 0;
        };
        return taken(bits_) + taken(lit_);
    }
    const gpu::Buffer& bits() const { return bits_; }     // uint[bins][words], a bit for each light
    const gpu::Buffer& depths() const { return depths_; } // float[]: all volumes (LocalLight::volume)
    const gpu::Buffer& lit() const { return lit_; }       // vec3[rows][columns] of the last eye's pixels, W/(m^2 sr)
    void giveBack();

private:
    void fit(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name) const;

    const gpu::Device& device_;
    gpu::Variants depths_program_, bins_program_, program_;
    gpu::Buffer bits_, depths_, lit_;
    std::vector<gpu::LocalLight> last_lights_; // the lights that depths_ belong to
    uint64_t last_medium_ = 0;                 // MediumView::version of the particles in depths_
};

} // namespace brume

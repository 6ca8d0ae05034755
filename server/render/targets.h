// The images that eyes are drawn into one after the other, and reading them back for measurements.
#pragma once

#include <list>
#include <span>
#include <vector>

#include "server/gpu/commands.h"
#include "server/inputs/eye_inputs.h"
#include "server/inputs/eye_request.h"

namespace brume {

// 16 bits would not do for what accumulates: T near 1 rounds by 2.4e-4 there, so that a layer of optical depth 2e-4
// changes nothing, and ten thousand of those are T = 0.14.
inline constexpr VkFormat kRadianceFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

// Targets of several sizes in the same memory, as much as the largest picture needs: a wide picture and a high one take
// no more than either. One of them has content at a time.
class Targets {
public:
    explicit Targets(const gpu::Device& device) : device_(device) {}

    // Makes a target for each of `eyes`, and keeps some of other sizes. Precondition: the device uses none of them.
    void makeRoom(std::span<const EyeRequest> eyes);
    // A target of at least this size. Precondition: fit() had an eye that large. Valid until the next fit().
    const RenderTarget& of(VkExtent2D size) const;
    // The target that is drawn into next. What it held is lost if another one was used since.
    void use(VkCommandBuffer cmd, const RenderTarget& target);
    // Frees all. Precondition as for fit().
    void giveBack();
    uint64_t bytes() const { return memory_.bytes(); }
    static constexpr uint64_t kBytesOfPixel = 20; // four floats of radiance, one of view depth

private:
    const RenderTarget* find(VkExtent2D size) const;
    void make(VkExtent2D size);

    const gpu::Device& device_;
    gpu::Allocation memory_;          // outlives the images
    std::list<RenderTarget> targets_; // the newest first
    const RenderTarget* used_ = nullptr;
};

struct Rows {
    uint32_t first, end;
};
// Copies rows of the target's radiance, `width` pixels each, to the same places of a buffer that begins with row 0.
// Precondition: the device is done with them.
void copyRows(VkCommandBuffer cmd, const RenderTarget& target, uint32_t width, Rows rows, const gpu::Buffer& to);

// The first `size` pixels of the target's radiance, row by row. Waits for the device: slow, for tests and measurements.
std::vector<glm::vec4> readTarget(const gpu::Device& device, const RenderTarget& target, VkExtent2D size);

// The same of the view depths of surfaces.
std::vector<float> readDepths(const gpu::Device& device, const RenderTarget& target, VkExtent2D size);

// A picture of `size` out of every `step`-th of its pixels, `nodes` of them a row, as present.comp interpolates them.
std::vector<glm::vec4> interpolated(std::span<const glm::vec4> pixels, uint32_t nodes, VkExtent2D size, uint32_t step);

} // namespace brume

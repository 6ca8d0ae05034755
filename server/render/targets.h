// The images that eyes are drawn into one after the other: made as large as the largest, and read back for
// measurements.
#pragma once

#include <span>
#include <vector>

#include "server/gpu/commands.h"
#include "server/inputs/eye_inputs.h"
#include "server/inputs/eye_request.h"

namespace brume {

// 16 bits would not do for what accumulates: T near 1 rounds by 2.4e-4 there, so that a layer of optical depth 2e-4
// changes nothing, and ten thousand of those are T = 0.14.
inline constexpr VkFormat kRadianceFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

// Makes the target hold the largest of `eyes`; what it held is lost when it grows. Precondition: the device does not
// use it.
void fitTarget(const gpu::Device& device, VkCommandBuffer cmd, RenderTarget& target, std::span<const EyeRequest> eyes);

// The first `size` pixels of the target's radiance, row by row. Waits for the device: slow, for tests and measurements.
std::vector<glm::vec4> readTarget(const gpu::Device& device, const RenderTarget& target, VkExtent2D size);

// A picture of `size` out of every `step`-th of its pixels, `nodes` of them a row, as present.comp interpolates them.
std::vector<glm::vec4> interpolated(std::span<const glm::vec4> pixels, uint32_t nodes, VkExtent2D size, uint32_t step);

} // namespace brume

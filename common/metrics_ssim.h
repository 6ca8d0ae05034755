// Structural similarity: Wang, Bovik, Sheikh, Simoncelli, Image Quality Assessment: From Error Visibility to Structural
// Similarity (2004).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace brume {

inline constexpr int kSsimRadius = 5; // 11 x 11 pixels, Gaussian of standard deviation 1.5

// Mean SSIM over all windows that lie completely in the picture; with a mask, their middle pixel is in it. K1 = 0.01,
// K2 = 0.03, values in [0, 1]. The result is in [-1, 1], 1 for equal pictures, symmetric; NaN if there is no such
// window. Preconditions: width * height values each; a mask is empty or has as many.
double ssim(int width, int height, std::span<const float> a, std::span<const float> b,
            std::span<const uint8_t> mask = {});

// Luma of sRGB pixels, by the formula of JPEG (BT.601).
std::vector<float> luma(std::span<const glm::vec3> srgb);

} // namespace brume

// LDR-FLIP, version 1.6: the difference that people see when two pictures alternate in place. Andersson, Nilsson,
// Akenine-Moeller, Oskarsson, Aastroem, Fairchild, FLIP: A Difference Evaluator for Alternating Images (2020), with
// the authors' later white point.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "common/image.h"

namespace brume {

// Pixels per degree of a display of 3840 pixels on 0.7 m, seen from 0.7 m.
inline constexpr float kPixelsPerDegree = 67.0206f;

// FLIP of every pixel, in [0, 1], 0 for equal pictures; symmetric. The light is linear Rec. 709 of a display, clamped
// to [0, 1] (the paper's sRGB values, decoded). Preconditions: width * height values each, finite; pixels_per_degree
// in [10, 200].
std::vector<float> flipMap(int width, int height, std::span<const glm::vec3> value,
                           std::span<const glm::vec3> reference, float pixels_per_degree = kPixelsPerDegree);

// FLIP of two pictures as they are displayed. NaN counts as black; compare() reports it. Throws std::invalid_argument
// if sizes differ.
std::vector<float> flipMap(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display);

// A FLIP map as sRGB pixels: from black (0) to white-yellow (1) with rising lightness (magma, fitted by a polynomial
// of degree 6).
std::vector<glm::u8vec3> colourMap(std::span<const float> map);

} // namespace brume

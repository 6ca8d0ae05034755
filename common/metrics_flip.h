// LDR-FLIP, version 1.6: the difference that is seen when two pictures alternate in place. Andersson, Nilsson, Akenine-Moeller,
// Oskarsson, Aastroem, Fairchild, FLIP: A Difference Evaluator for Alternating Images (2020), with the authors' later white
// point.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "common/image.h"

namespace brume {

// 3840 pixels on 0.7 m, seen from 0.7 m.
inline constexpr float kPixelsPerDegree = 67.0206f;

// Per pixel in [0, 1], 0 where nothing differs; symmetric. Light is linear Rec. 709 of a display, clamped to [0, 1] (the sRGB
// values that the paper starts from, decoded). Preconditions: width * height values each, finite; pixels_per_degree in [10, 200].
std::vector<float> flipMap(int width, int height, std::span<const glm::vec3> value, std::span<const glm::vec3> reference,
                           float pixels_per_degree = kPixelsPerDegree);

// The same of two pictures as they are displayed. Throws std::invalid_argument when sizes differ. What is not a number counts as
// black: compare() tells of it.
std::vector<float> flipMap(const RadianceImage& value, const RadianceImage& reference, const DisplaySettings& display);

// A map as sRGB pixels: black 0, white-yellow 1, lightness grows all the way (magma; a polynomial of degree 6 fitted to it).
std::vector<glm::u8vec3> colourMap(std::span<const float> map);

} // namespace brume

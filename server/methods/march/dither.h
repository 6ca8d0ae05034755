// Dither: the patterns by which method `march` moves the samples of neighbouring pixels (MarchSettings::dither).
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace brume {

inline constexpr uint32_t kDitherSide = 64; // pixels along a side of a table, which is repeated

// The number of a pixel in Bayer's matrix of 2^levels a side (An optimum method for two-level rendition of
// continuous-tone pictures, 1973), 0 ... 4^levels - 1. Levels 1 ... 8.
uint32_t bayerNumber(uint32_t x, uint32_t y, uint32_t levels);

// An offset in (0, 1) for each pixel [row][column] of a table, all of them with mean 1/2. Pattern `white` is one
// shuffle of 0 ... 63 in a square of 8x8, repeated, as in the thesis. Pattern `blue` is made by void and cluster
// (Ulichney, The void-and-cluster method for dither array generation, 1993), in a tenth of a second. All others, `none`
// and the formula of `ign` among them, are 1/2 everywhere.
std::vector<float> ditherTable(std::string_view pattern);

} // namespace brume

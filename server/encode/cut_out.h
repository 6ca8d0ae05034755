// A picture without its sky: what is left has an alpha, and over the sky it is the whole picture again.
#pragma once

#include <cstdint>
#include <vector>

#include "common/camera.h"
#include "common/scene.h"

namespace brume {

// A picture before it is shown, with what is behind it. Lists are row by row from the top left.
struct RawPicture {
    uint32_t width = 0, height = 0;  // pixels
    std::vector<glm::vec4> radiance; // linear red, green and blue, and the medium's transmittance
    std::vector<float> view_depth;   // m, of the surface at each pixel; kNoSurface and more: the sky. Empty: all is sky
    Pose eye;
    Sky sky;
    float exposure = 1;
    bool filmic = true;
};
inline constexpr float kNoSurface = 1e20f;

// Linear radiance times alpha, and alpha in [0, 1]: 1 where a surface is, else 1 - transmittance, or more where that
// takes a colour below 0. The pixel is this + (1 - alpha) * the sky's radiance.
std::vector<glm::vec4> premultiplied(const RawPicture& picture);
// As a display shows it, sRGB, straight: alpha * this + (1 - alpha) * the shown sky is the shown pixel. Alpha is more
// than 1 - transmittance where that takes a colour out of [0, 1].
std::vector<glm::vec4> straight(const RawPicture& picture);
// Of the pixel (x, y), linear.
glm::vec3 skyBehind(const RawPicture& picture, uint32_t x, uint32_t y);
// What a display shows of linear radiance, sRGB in [0, 1], as shaders/compose.comp does.
glm::vec3 shown(const RawPicture& picture, glm::vec3 radiance);

// RGBA, 8 bits a channel, of straight(). Throws std::runtime_error.
std::vector<uint8_t> cutOutPng(const RawPicture& picture);
// OpenEXR: half floats R, G, B, A of premultiplied(), compressed line by line (ZIPS). Throws std::runtime_error.
std::vector<uint8_t> cutOutExr(const RawPicture& picture);

} // namespace brume

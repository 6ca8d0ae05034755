#include "server/encode/cut_out.h"

#include <algorithm>
#include <cmath>

#include "server/encode/exr.h"
#include "server/encode/png.h"
#include "shaders/shared/sky.h"
#include "shaders/shared/srgb.h"

namespace brume {
namespace {

// Calls `f` with the number, the coordinates, the pixel and the least alpha of each pixel.
template <class F>
std::vector<glm::vec4> each(const RawPicture& picture, F f) {
    std::vector<glm::vec4> out;
    out.reserve(picture.radiance.size());
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0; x < picture.width; ++x) {
            const size_t i = out.size();
            const glm::vec4& pixel = picture.radiance[i];
            const bool surface = !picture.view_depth.empty() && picture.view_depth[i] < kNoSurface;
            const float alpha = surface ? 1 : std::clamp(1 - pixel.a, 0.0f, 1.0f);
            out.push_back(f(glm::vec3(pixel), skyBehind(picture, x, y), alpha));
        }
    return out;
}

// The least alpha, at least `alpha`, with which no channel of whole - (1 - alpha) * behind is below 0. The smoothed
// edge of a dark surface in front of the sky takes more than there is medium.
float alphaFor(glm::vec3 whole, glm::vec3 behind, float alpha) {
    for (int c = 0; c < 3; ++c)
        if (behind[c] > 0) alpha = std::max(alpha, 1 - whole[c] / behind[c]);
    return std::clamp(alpha, 0.0f, 1.0f);
}

} // namespace

glm::vec3 skyBehind(const RawPicture& picture, uint32_t x, uint32_t y) {
    const Frustum f = frustumOf(picture.eye, picture.width, picture.height);
    const float u = (float(x) + 0.5f) / float(picture.width), v = (float(y) + 0.5f) / float(picture.height);
    const glm::vec3 in_view((f.left + f.right) * u - f.left, f.up - (f.up + f.down) * v, -1);
    const glm::vec3 direction = glm::normalize(picture.eye.orientation * in_view);
    return glm::mix(picture.sky.horizon, picture.sky.zenith, physics::skyZenithPart(direction.y));
}

glm::vec3 shown(const RawPicture& picture, glm::vec3 radiance) {
    glm::vec3 out;
    for (int c = 0; c < 3; ++c) {
        const float x = std::max(radiance[c] * picture.exposure, 0.0f), y = std::min(x, 1e4f);
        const float light = picture.filmic ? y * (2.51f * y + 0.03f) / (y * (2.43f * y + 0.59f) + 0.14f) : x;
        out[c] = std::clamp(float(physics::srgb(std::clamp(light, 0.0f, 1.0f))), 0.0f, 1.0f);
    }
    return out;
}

std::vector<glm::vec4> premultiplied(const RawPicture& picture) {
    return each(picture, [](glm::vec3 whole, glm::vec3 sky, float least) {
        const float alpha = alphaFor(whole, sky, least);
        return glm::vec4(glm::max(whole - (1 - alpha) * sky, 0.0f), alpha);
    });
}

std::vector<glm::vec4> straight(const RawPicture& picture) {
    return each(picture, [&](glm::vec3 whole, glm::vec3 sky, float least) {
        const glm::vec3 over = shown(picture, whole), behind = shown(picture, sky);
        // As well, no channel is above 1: what is left of white is no more than alpha.
        const float alpha = alphaFor(1.0f - over, 1.0f - behind, alphaFor(over, behind, least));
        if (!(alpha > 0)) return glm::vec4(0);
        return glm::vec4(glm::clamp((over - (1 - alpha) * behind) / alpha, 0.0f, 1.0f), alpha);
    });
}

std::vector<uint8_t> cutOutPng(const RawPicture& picture) {
    std::vector<uint8_t> pixels;
    pixels.reserve(4 * picture.radiance.size());
    for (const glm::vec4& pixel : straight(picture))
        for (int c = 0; c < 4; ++c) pixels.push_back(uint8_t(std::lround(255 * pixel[c])));
    return encodeRgbaPng(pixels.data(), picture.width, picture.height);
}

std::vector<uint8_t> cutOutExr(const RawPicture& picture) {
    return encodeExr(premultiplied(picture), picture.width, picture.height);
}

} // namespace brume

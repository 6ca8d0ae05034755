// Light maps of PNG files.
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <png.h>

#include "server/methods/sprites/puffs.h"

namespace brume::methods::sprites {
namespace {

constexpr uint32_t kMostSide = 512, kMostTexels = 1 << 20; // texels of all frames: 32 MiB

struct Pixels {
    uint32_t width = 0, height = 0;
    std::vector<glm::u8vec4> rgba;
};

Pixels read(const std::filesystem::path& file) {
    const auto fail = [&](const std::string& why) {
        throw std::runtime_error(file.string() + ": " + why +
                                 "; render.sprites.maps needs two PNG files with frames "
                                 "beside each other, each as wide as high, up to 512 pixels, a million together");
    };
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    const std::unique_ptr<png_image, void (*)(png_image*)> guard(&image, png_image_free);
    if (png_image_begin_read_from_file(&image, file.c_str()) == 0) fail(image.message);
    Pixels out{image.width, image.height, {}};
    if (out.height == 0 || out.height > kMostSide || out.width % out.height != 0 ||
        uint64_t(out.width) * out.height > kMostTexels)
        fail(std::to_string(out.width) + "x" + std::to_string(out.height) + " pixels");
    image.format = PNG_FORMAT_RGBA;
    out.rgba.resize(size_t(out.width) * out.height);
    if (png_image_finish_read(&image, nullptr, out.rgba.data(), 0, nullptr) == 0) fail(image.message);
    return out;
}

} // namespace

LightMaps mapsOf(const std::filesystem::path& name) {
    if (name.empty())
        throw std::runtime_error(
            "render.sprites.maps: \"files\" without files; give medium.sprite_maps, the first part "
            "of NAME-positive.png and NAME-negative.png");
    const Pixels positive = read(name.string() + "-positive.png"), negative = read(name.string() + "-negative.png");
    if (positive.width != negative.width || positive.height != negative.height)
        throw std::runtime_error(name.string() + "-negative.png: its size is not that of " + name.filename().string() +
                                 "-positive.png");
    LightMaps maps{positive.height, positive.width / positive.height, {}, {}};
    for (uint32_t frame = 0; frame < maps.frames; ++frame) {
        double sum = 0;
        const size_t first = maps.positive.size();
        for (uint32_t y = 0; y < maps.side; ++y)
            for (uint32_t x = 0; x < maps.side; ++x) {
                const size_t at = size_t(y) * positive.width + size_t(frame) * maps.side + x;
                const glm::vec4 one = glm::vec4(positive.rgba[at]) / 255.0f,
                                other = glm::vec4(negative.rgba[at]) / 255.0f;
                const float depth = -std::log1p(-std::min(one.a, 254.0f / 255));
                maps.positive.emplace_back(glm::vec3(one), depth);
                maps.negative.emplace_back(glm::vec3(other), 0);
                sum += double(depth);
            }
        const double texels = double(maps.side) * maps.side;
        for (size_t i = first; i < maps.positive.size(); ++i) maps.positive[i].w *= float(texels / std::max(sum, 1e-9));
    }
    return maps;
}

} // namespace brume::methods::sprites

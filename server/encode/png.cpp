#include "server/encode/png.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <png.h>

#include "server/encode/rgb.h"

namespace brume {

namespace {

// Pixels of `format`, `stride` bytes a row; 0: without gaps. Empty if it would be larger than `most` bytes.
std::vector<uint8_t> encode(const uint8_t* pixels, uint32_t width, uint32_t height, uint32_t format, uint32_t stride,
                            size_t most) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = format;
    image.flags = PNG_IMAGE_FLAG_FAST; // a few per cent larger, several times sooner
    std::vector<uint8_t> out(std::min<size_t>(most, PNG_IMAGE_PNG_SIZE_MAX(image)));
    png_alloc_size_t size = out.size();
    const bool whole =
        png_image_write_to_memory(&image, out.data(), &size, 0, pixels, png_int_32(stride), nullptr) != 0;
    if (!whole && size <= out.size()) throw std::runtime_error(std::string("libpng: ") + image.message);
    out.resize(whole ? size : 0);
    return out;
}

} // namespace

std::vector<uint8_t> encodePng(const PictureView& picture, size_t most) {
    std::vector<uint8_t> pixels;
    packRgb(picture, pixels);
    return encode(pixels.data(), picture.layout.width, picture.layout.height, PNG_FORMAT_RGB, 0, most);
}

std::vector<uint8_t> encodeRgbaPng(const uint8_t* pixels, uint32_t width, uint32_t height) {
    return encode(pixels, width, height, PNG_FORMAT_RGBA, 0, SIZE_MAX);
}

std::vector<uint8_t> encodeGreyPng(const uint8_t* plane, uint32_t width, uint32_t height, uint32_t stride) {
    return encode(plane, width, height, PNG_FORMAT_GRAY, stride, SIZE_MAX);
}

} // namespace brume

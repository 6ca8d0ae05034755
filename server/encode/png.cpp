#include "server/encode/png.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <png.h>

#include "server/encode/rgb.h"

namespace brume {

std::vector<uint8_t> encodePng(const PictureView& picture, size_t most) {
    std::vector<uint8_t> pixels;
    packRgb(picture, pixels);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = picture.layout.width;
    image.height = picture.layout.height;
    image.format = PNG_FORMAT_RGB;
    image.flags = PNG_IMAGE_FLAG_FAST; // a few per cent larger, several times sooner
    std::vector<uint8_t> out(std::min<size_t>(most, PNG_IMAGE_PNG_SIZE_MAX(image)));
    png_alloc_size_t size = out.size();
    const bool whole = png_image_write_to_memory(&image, out.data(), &size, 0, pixels.data(), 0, nullptr) != 0;
    if (!whole && size <= out.size()) throw std::runtime_error(std::string("libpng: ") + image.message);
    out.resize(whole ? size : 0);
    return out;
}

} // namespace brume

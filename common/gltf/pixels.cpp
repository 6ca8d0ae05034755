#include "common/gltf/pixels.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include <png.h>
#include <turbojpeg.h>

#include "common/gltf/told.h"
#include "common/gltf/wrong.h"

namespace brume::gltf {
namespace {

constexpr size_t kLongestReason = 100; // bytes, of what a library says

struct Allowed {
    int side;    // pixels
    size_t area; // in all
};

void checkSize(int64_t width, int64_t height, const Allowed& allowed) {
    if (width < 1 || height < 1 || width > allowed.side || height > allowed.side)
        fail("an image of {} x {} pixels; allowed: 1 to {} a side", width, height, allowed.side);
    if (size_t(width * height) > allowed.area) fail("more pixels with other images than are allowed");
}

Pixels ofPng(const Bytes& file, const Allowed& allowed) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    const std::unique_ptr<png_image, void (*)(png_image*)> freed(&image, png_image_free);
    const auto check = [&](int good) {
        if (!good) fail("a broken PNG image: {}", shortened(image.message, kLongestReason));
    };
    check(png_image_begin_read_from_memory(&image, file.data(), file.size()));
    checkSize(image.width, image.height, allowed);
    image.format = PNG_FORMAT_RGBA;
    Pixels out{int(image.width), int(image.height), {}};
    out.texels.resize(size_t(image.width) * image.height);
    check(png_image_finish_read(&image, nullptr, out.texels.data(), 0, nullptr));
    return out;
}

Pixels ofJpeg(const Bytes& file, const Allowed& allowed) {
    const std::unique_ptr<void, int (*)(void*)> reader(tjInitDecompress(), tjDestroy);
    if (!reader) fail("too little memory for a JPEG image");
    Pixels out;
    const auto check = [&](int result) {
        const bool whole = result == 0 || tjGetErrorCode(reader.get()) ==
                                              TJERR_WARNING; // true: also of a cut image, of which a part is there
        if (!whole || out.width == 0)
            fail("a broken JPEG image: {}", shortened(tjGetErrorStr2(reader.get()), kLongestReason));
    };
    int subsampling = 0, space = 0;
    const auto size = static_cast<unsigned long>(file.size());
    check(tjDecompressHeader3(reader.get(), file.data(), size, &out.width, &out.height, &subsampling, &space));
    checkSize(out.width, out.height, allowed);
    out.texels.resize(size_t(out.width) * size_t(out.height));
    check(tjDecompress2(reader.get(), file.data(), size, reinterpret_cast<unsigned char*>(out.texels.data()), out.width,
                        0, out.height, TJPF_RGBA, TJFLAG_LIMITSCANS));
    return out;
}

} // namespace

Pixels pixelsOf(const Bytes& file, int most, size_t left) {
    constexpr std::array<unsigned char, 4> kPng{0x89, 'P', 'N', 'G'};
    constexpr std::array<unsigned char, 3> kJpeg{0xff, 0xd8, 0xff};
    const auto begins = [&](const auto& with) {
        return file.size() >= with.size() && std::equal(with.begin(), with.end(), file.begin());
    };
    if (begins(kPng)) return ofPng(file, {most, left});
    if (begins(kJpeg)) return ofJpeg(file, {most, left});
    fail("an image that is neither PNG nor JPEG");
}

} // namespace brume::gltf

#include "client/native/jpeg.h"

#include <stdexcept>

#include <png.h>
#include <turbojpeg.h>

namespace brume::client {

void JpegDecoder::Free::operator()(void* handle) const { tjDestroy(handle); }

JpegDecoder::JpegDecoder() : handle_(tjInitDecompress()) {
    if (!handle_) throw std::runtime_error("libjpeg-turbo does not start: " + std::string(tjGetErrorStr2(nullptr)));
}
JpegDecoder::~JpegDecoder() = default;
JpegDecoder::JpegDecoder(JpegDecoder&&) noexcept = default;

bool isPng(std::span<const uint8_t> bytes) { return bytes.size() >= 8 && png_sig_cmp(bytes.data(), 0, 8) == 0; }

bool JpegDecoder::decodePng(std::span<const uint8_t> png, int width, int height, uint8_t* pixels, int pitch,
                            int format) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    bool good = png_image_begin_read_from_memory(&image, png.data(), png.size()) != 0;
    if (good && (image.width != uint32_t(width) || image.height != uint32_t(height))) {
        error_ = "a PNG of another size than its frame's";
        png_image_free(&image);
        return false;
    }
    image.format = format == TJPF_BGRX ? PNG_FORMAT_BGRA : PNG_FORMAT_RGB;
    good = good && png_image_finish_read(&image, nullptr, pixels, pitch, nullptr) != 0;
    if (!good) error_ = image.message;
    png_image_free(&image);
    return good;
}

bool JpegDecoder::decodeAs(std::span<const uint8_t> jpeg, int width, int height, uint8_t* pixels, int pitch,
                           int format) {
    if (isPng(jpeg)) return decodePng(jpeg, width, height, pixels, pitch, format);
    int w = 0, h = 0, subsampling = 0, colour_space = 0;
    if (tjDecompressHeader3(handle_.get(), jpeg.data(), jpeg.size(), &w, &h, &subsampling, &colour_space) != 0) {
        error_ = tjGetErrorStr2(handle_.get());
        return false;
    }
    if (w != width || h != height) {
        error_ = "a JPEG of " + std::to_string(w) + "x" + std::to_string(h) + " in a frame of " +
                 std::to_string(width) + "x" + std::to_string(height);
        return false;
    }
    // A warning (a truncated or damaged picture) is an error here: the bytes came over a reliable socket.
    if (tjDecompress2(handle_.get(), jpeg.data(), jpeg.size(), pixels, w, pitch, h, format, TJFLAG_STOPONWARNING) !=
        0) {
        error_ = tjGetErrorStr2(handle_.get());
        return false;
    }
    return true;
}

bool JpegDecoder::decodeBgra(std::span<const uint8_t> jpeg, int width, int height, uint8_t* pixels, int pitch) {
    return decodeAs(jpeg, width, height, pixels, pitch, TJPF_BGRX);
}

bool JpegDecoder::decode(std::span<const uint8_t> jpeg, int width, int height, Picture& out) {
    out.width = width;
    out.height = height;
    out.rgb.resize(size_t(width) * size_t(height) * 3);
    return decodeAs(jpeg, width, height, out.rgb.data(), width * 3, TJPF_RGB);
}

} // namespace brume::client

#include "server/encode/jpeg.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <turbojpeg.h>

#include "server/encode/rgb.h"

namespace brume {

JpegEncoder::JpegEncoder() : handle_(tjInitCompress()) {
    if (!handle_) throw std::runtime_error("libjpeg-turbo cannot start");
}

JpegEncoder::~JpegEncoder() { tjDestroy(handle_); }

// Makes room for a picture of the size.
unsigned long JpegEncoder::makeRoom(uint32_t width, uint32_t height, int sampling) {
    const size_t most = tjBufSize(int(width), int(height), sampling);
    if (most == size_t(-1)) throw std::runtime_error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(nullptr));
    if (scratch_.size() < most) scratch_.resize(most);
    return scratch_.size();
}

std::vector<uint8_t> JpegEncoder::done(bool failed, unsigned long size) const {
    if (failed) throw std::runtime_error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(handle_));
    return {scratch_.begin(), scratch_.begin() + std::ptrdiff_t(size)};
}

std::vector<uint8_t> JpegEncoder::encodeGrey(const uint8_t* plane, uint32_t width, uint32_t height, uint32_t stride,
                                             int quality) {
    unsigned long size = makeRoom(width, height, TJSAMP_GRAY);
    unsigned char* out = scratch_.data();
    const int failed = tjCompress2(handle_, plane, int(width), int(stride), int(height), TJPF_GRAY, &out, &size,
                                   TJSAMP_GRAY, std::clamp(quality, 1, 100), TJFLAG_NOREALLOC);
    return done(failed != 0, size);
}

std::vector<uint8_t> JpegEncoder::encode(const PictureView& picture, int quality, bool half_chroma) {
    const PlaneLayout& layout = picture.layout;
    const int width = int(layout.width), height = int(layout.height);
    const int sampling = layout.full && !half_chroma ? TJSAMP_444 : TJSAMP_420;
    unsigned long size = makeRoom(layout.width, layout.height, sampling);
    unsigned char* out = scratch_.data();
    quality = std::clamp(quality, 1, 100);
    int failed = 0;
    if (layout.full) {
        packRgb(picture, rgb_);
        failed = tjCompress2(handle_, rgb_.data(), width, 0, height, TJPF_RGB, &out, &size, sampling, quality,
                             TJFLAG_NOREALLOC);
    } else {
        const unsigned char* planes[] = {picture.bytes, picture.bytes + layout.lumaBytes(),
                                         picture.bytes + layout.lumaBytes() + layout.chromaBytes()};
        const int strides[] = {int(layout.lumaStride()), int(layout.chromaStride()), int(layout.chromaStride())};
        failed = tjCompressFromYUVPlanes(handle_, planes, width, strides, height, sampling, &out, &size, quality,
                                         TJFLAG_NOREALLOC);
    }
    return done(failed != 0, size);
}

} // namespace brume

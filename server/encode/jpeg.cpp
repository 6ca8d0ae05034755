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

std::vector<uint8_t> JpegEncoder::encode(const PictureView& picture, int quality, bool half_chroma) {
    const PlaneLayout& layout = picture.layout;
    const int width = int(layout.width), height = int(layout.height);
    const int sampling = layout.full && !half_chroma ? TJSAMP_444 : TJSAMP_420;
    const size_t most = tjBufSize(width, height, sampling);
    if (most == size_t(-1)) throw std::runtime_error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(nullptr));
    if (scratch_.size() < most) scratch_.resize(most);
    unsigned char* out = scratch_.data();
    unsigned long size = scratch_.size();
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
    if (failed != 0) throw std::runtime_error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(handle_));
    return {scratch_.begin(), scratch_.begin() + std::ptrdiff_t(size)};
}

} // namespace brume

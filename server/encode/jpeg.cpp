#include "server/encode/jpeg.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <turbojpeg.h>

namespace brume {

JpegEncoder::JpegEncoder() : handle_(tjInitCompress()) {
    if (!handle_) throw std::runtime_error("libjpeg-turbo cannot start");
}

JpegEncoder::~JpegEncoder() { tjDestroy(handle_); }

std::vector<uint8_t> JpegEncoder::encode(const PictureView& picture, int quality) {
    const PlaneLayout& layout = picture.layout;
    const int width = int(layout.width), height = int(layout.height);
    const size_t most = tjBufSize(width, height, TJSAMP_420);
    if (scratch_.size() < most) scratch_.resize(most);
    const unsigned char* planes[] = {picture.bytes, picture.bytes + layout.lumaBytes(),
                                     picture.bytes + layout.lumaBytes() + layout.chromaBytes()};
    const int strides[] = {int(layout.lumaStride()), int(layout.chromaStride()), int(layout.chromaStride())};
    unsigned char* out = scratch_.data();
    unsigned long size = scratch_.size();
    if (tjCompressFromYUVPlanes(handle_, planes, width, strides, height, TJSAMP_420, &out, &size, std::clamp(quality, 1, 100),
                                TJFLAG_NOREALLOC) != 0)
        throw std::runtime_error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(handle_));
    return {scratch_.begin(), scratch_.begin() + std::ptrdiff_t(size)};
}

} // namespace brume

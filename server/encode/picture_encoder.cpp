#include "server/encode/picture_encoder.h"

#include <utility>

#include "server/encode/png.h"

namespace brume {
namespace {

constexpr size_t kMostPng = 4 << 20; // bytes; a larger picture comes as JPEG of the following quality, 4:4:4
constexpr uint8_t kNearlyLossless = 97;

PictureBytes shared(std::vector<uint8_t> bytes) {
    return std::make_shared<const std::vector<uint8_t>>(std::move(bytes));
}

} // namespace

EncodedPictures encodePictures(std::span<const PictureView> eyes, const EncodeRequest& request, JpegEncoder& jpeg) {
    EncodedPictures out;
    bool fits = request.lossless; // True: every eye's PNG so far is small enough
    for (size_t eye = 0; fits && eye < eyes.size(); ++eye) {
        out.bytes[eye] = shared(encodePng(eyes[eye], kMostPng));
        fits = !out.bytes[eye]->empty();
    }
    if (fits) {
        out.format = PictureFormat::png;
        out.quality = 100;
        return out;
    }
    out.quality = request.lossless ? kNearlyLossless : request.quality;
    for (size_t eye = 0; eye < eyes.size(); ++eye)
        out.bytes[eye] = shared(jpeg.encode(eyes[eye], out.quality, !request.full_colour));
    return out;
}

} // namespace brume

// Encodes a picture's planes to the bytes that a viewer gets, in the format that it asked for.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/encode/jpeg.h"

namespace brume {

// Bytes of one picture. Viewers that ask for the same picture share them.
using PictureBytes = std::shared_ptr<const std::vector<uint8_t>>;

enum class PictureFormat : uint8_t { jpeg, png };

struct EncodedPictures {
    std::array<PictureBytes, 2> bytes; // one for each eye
    PictureFormat format = PictureFormat::jpeg;
    uint8_t quality = 0; // JPEG quality, 1 ... 100; 100 for PNG
};

struct EncodeRequest {
    uint8_t quality = 80;  // JPEG, 1 ... 100
    bool lossless = false; // True: PNG, or JPEG of quality 97 if PNG takes more than 4 MiB
    // False: JPEG with half as many chroma samples each way, also from planes R, G, B.
    bool full_colour = true;
};

// Encodes the pictures of one or two eyes. `jpeg`: the calling thread's own encoder. Precondition: for lossless
// pictures, layout.full (R, G, B at every pixel). Throws std::runtime_error or std::bad_alloc.
EncodedPictures encodePictures(std::span<const PictureView> eyes, const EncodeRequest& request, JpegEncoder& jpeg);

} // namespace brume

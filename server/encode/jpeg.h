// JpegEncoder: encodes planes with libjpeg-turbo. Y, Cb, Cr planes become 4:2:0, R, G, B planes 4:4:4.
#pragma once

#include <cstdint>
#include <vector>

#include "server/encode/picture.h"

namespace brume {

// To be used by one thread at a time. Keeps its scratch memory between pictures.
class JpegEncoder {
public:
    JpegEncoder();
    ~JpegEncoder();
    JpegEncoder(const JpegEncoder&) = delete;
    JpegEncoder& operator=(const JpegEncoder&) = delete;

    // `quality`: 1 ... 100. `half_chroma`: true for 4:2:0 from R, G, B planes, too. Throws std::runtime_error if
    // libjpeg-turbo refuses (a picture without pixels).
    std::vector<uint8_t> encode(const PictureView& picture, int quality, bool half_chroma = false);
    // Of one plane, in rows `stride` bytes apart. Throws as encode().
    std::vector<uint8_t> encodeGrey(const uint8_t* plane, uint32_t width, uint32_t height, uint32_t stride,
                                    int quality);
    // Bytes of scratch memory: about what the largest picture so far takes.
    uint64_t bytes() const { return scratch_.capacity() + rgb_.capacity(); }
    // Frees the scratch memory.
    void giveBack() {
        std::vector<uint8_t>().swap(scratch_);
        std::vector<uint8_t>().swap(rgb_);
    }

private:
    unsigned long makeRoom(uint32_t width, uint32_t height, int sampling);
    std::vector<uint8_t> done(bool failed, unsigned long size) const;

    void* handle_;
    std::vector<uint8_t> scratch_, rgb_;
};

} // namespace brume

// Decodes a frame's pictures: JPEG with libjpeg-turbo, PNG with libpng.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace brume::client {

struct Picture { // rows of RGB without gaps, the top row first
    int width = 0, height = 0;
    std::vector<uint8_t> rgb;
};

bool isPng(std::span<const uint8_t> bytes); // by the signature at their begin

class JpegDecoder {
public:
    JpegDecoder();
    ~JpegDecoder();
    JpegDecoder(JpegDecoder&&) noexcept;

    // Both return false if the bytes are not one whole JPEG or PNG of exactly this size; error() says why.
    // decodeBgra() writes `height` rows of `width` pixels of 4 bytes (B, G, R, 255), `pitch` bytes apart.
    bool decodeBgra(std::span<const uint8_t> jpeg, int width, int height, uint8_t* pixels, int pitch);
    bool decode(std::span<const uint8_t> jpeg, int width, int height, Picture& out);
    const std::string& error() const { return error_; }

private:
    bool decodePng(std::span<const uint8_t> png, int width, int height, uint8_t* pixels, int pitch, int format);
    bool decodeAs(std::span<const uint8_t> jpeg, int width, int height, uint8_t* pixels, int pitch, int format);

    struct Free {
        void operator()(void* handle) const;
    };
    std::unique_ptr<void, Free> handle_;
    std::string error_;
};

} // namespace brume::client

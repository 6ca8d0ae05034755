// Columns of LitParticles: particles and the light on them as whole numbers, and how messages pack them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace brume::lit {

// Messages are numbered from 1. Their layers make any viewer's rate a power of two slower than all: who leaves out the
// upper layers misses no reference. Layer 3 has every eighth message, layer 0 every second one.
inline constexpr uint32_t kLayers = 4;
inline uint32_t layerOf(uint32_t number) { return std::min<uint32_t>(uint32_t(std::countr_zero(number)), kLayers - 1); }
// The message whose rows this one's are differences to; 0: there is none.
inline uint32_t referenceOf(uint32_t number) {
    constexpr uint32_t kApart = 1u << (kLayers - 1);
    if (layerOf(number) < kLayers - 1) return number & (number - 1);
    return number > kApart ? number - kApart : 0;
}

// Columns, one number each for every particle. Numbers of a particle without a column are 0.
//  0 ...  2  place: origin + step * number, m
//  3, 4      scale (m) and extinction at the centre (1/m), as logCode()
//  5 ...  7  albedo in red, green, blue: number / 65535
//  8 ... 37  ten for each hue, of the fit to the sun's light (shaders/shared/lit_particles.h): middle as rootCode();
//            slope, bend and twist along x, y and z as signedCode()
// 38 ... 49  four for each channel: fluence that scattered more than once, for an irradiance of 1, as logCode(); and
// the
//            net flux over it along x, y and z as signedCode(). Without those of green and blue all have red's
inline constexpr uint32_t kPlace = 0, kScale = 3, kExtinction = 4, kAlbedo = 5, kFit = 8, kFitColumns = 10,
                          kFluence = 38, kFluenceColumns = 4, kColumns = 50, kHues = 3;
inline constexpr uint32_t kMostParticles = 65'536; // of a message

// Bits of a column's numbers: 16, or 8.
constexpr uint32_t bitsOf(uint32_t column) {
    return column < kFit || (column >= kFluence && (column - kFluence) % kFluenceColumns == 0) ? 16 : 8;
}

// A number from 2^-32 to 2^32 within 0.034 %; 0 stays 0.
inline uint16_t logCode(float x) {
    if (!(x > 0)) return 0;
    return uint16_t(std::clamp(std::round((std::log2(x) + 32.0f) * 1024.0f), 1.0f, 65535.0f));
}
inline float ofLogCode(uint16_t code) { return code == 0 ? 0 : std::exp2(float(code) / 1024.0f - 32.0f); }
// A number in [0, 1]: the finer, the smaller it is.
inline uint16_t rootCode(float x) { return uint16_t(std::lround(255.0f * std::sqrt(std::clamp(x, 0.0f, 1.0f)))); }
inline float ofRootCode(uint16_t code) { return float(code) / 255.0f * (float(code) / 255.0f); }
// A number in [-1, 1], also finer near 0: eight bits, two's complement.
inline uint16_t signedCode(float x) {
    const auto size = int(std::lround(127.0f * std::sqrt(std::min(std::abs(x), 1.0f))));
    return uint8_t(x < 0 ? -size : size);
}
inline float ofSignedCode(uint16_t code) {
    const float part = float(int8_t(uint8_t(code))) / 127.0f;
    return part * std::abs(part);
}

// Particles first, first + 1 ... first + count - 1.
struct Rows {
    uint64_t first = 0;
    uint32_t count = 0;
    std::array<std::vector<uint16_t>, kColumns> columns; // each of `count` numbers; empty: all are 0
};

// As a message has them.
struct PackedRows {
    uint64_t present = 0;       // bit i: column i is there; others are as in the reference, or 0 without one
    std::vector<uint8_t> bytes; // zlib's, of one column after another: low bytes, and of 16 bits then the high ones
};

// Packs rows as differences to those of the same particles in a reference; null: as they are.
class Packer {
public:
    Packer();
    ~Packer();
    Packer(const Packer&) = delete;
    Packer& operator=(const Packer&) = delete;

    // Throws std::bad_alloc.
    PackedRows pack(const Rows& rows, const Rows* reference);

private:
    struct Deflate;
    void deflate(std::vector<uint8_t>& out);

    std::vector<uint8_t> plain_;
    std::vector<size_t> ends_; // of parts of plain_ whose numbers are alike
    std::unique_ptr<Deflate> zlib_;
};

// Bytes before they are packed.
uint64_t plainBytes(uint64_t present, uint32_t count);

// The rows of a message. Nothing if the bytes are not exactly those of these columns, or for more than kMostParticles.
// `first`, `count`, `present`, `bytes`: as the message has them. `reference`: the rows that it names; null: none.
std::optional<Rows> unpack(uint64_t first, uint32_t count, uint64_t present, std::span<const uint8_t> bytes,
                           const Rows* reference);

} // namespace brume::lit

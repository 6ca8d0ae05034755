#include "server/encode/exr.h"

#include <bit>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include <glm/gtc/packing.hpp>
#include <zlib.h>

namespace brume {
namespace {

static_assert(std::endian::native == std::endian::little, "OpenEXR is little-endian");

constexpr float kMostHalf = 65504;
constexpr int kHalf = 1;     // type of a channel
constexpr uint8_t kZips = 2; // compression

class Bytes {
public:
    std::vector<uint8_t> all;

    template <class T>
    void add(T value) {
        const auto* from = reinterpret_cast<const uint8_t*>(&value);
        all.insert(all.end(), from, from + sizeof value);
    }
    void text(std::string_view one) { // with a zero behind it
        all.insert(all.end(), one.begin(), one.end());
        all.push_back(0);
    }
    void attribute(std::string_view name, std::string_view type, int32_t size) { text(name), text(type), add(size); }
};

// Even bytes, then odd ones, as differences to the byte before: as the format's ZIP wants a line.
void prepare(std::span<const uint8_t> line, std::vector<uint8_t>& out) {
    out.clear();
    for (const size_t first : {size_t{0}, size_t{1}})
        for (size_t i = first; i < line.size(); i += 2) out.push_back(line[i]);
    uint8_t before = out.front();
    for (size_t i = 1; i < out.size(); ++i) {
        const uint8_t now = out[i];
        out[i] = uint8_t(now - before + 128);
        before = now;
    }
}

} // namespace

std::vector<uint8_t> encodeExr(std::span<const glm::vec4> pixels, uint32_t width, uint32_t height) {
    if (width == 0 || height == 0 || pixels.size() != size_t{width} * height)
        throw std::runtime_error("OpenEXR: pixels that do not fit the size");
    Bytes out;
    out.add(uint32_t{20000630}), out.add(uint32_t{2});
    constexpr std::string_view kChannels = "ABGR"; // in the order of their names, as in each line
    out.attribute("channels", "chlist", int32_t(kChannels.size() * 18 + 1));
    for (const char& name : kChannels) {
        out.text(std::string_view(&name, 1));
        out.add(int32_t{kHalf}), out.add(uint32_t{0}), out.add(int32_t{1}), out.add(int32_t{1});
    }
    out.add(uint8_t{0});
    out.attribute("compression", "compression", 1), out.add(kZips);
    for (const char* window : {"dataWindow", "displayWindow"}) {
        out.attribute(window, "box2i", 16);
        out.add(int32_t{0}), out.add(int32_t{0}), out.add(int32_t(width) - 1), out.add(int32_t(height) - 1);
    }
    out.attribute("lineOrder", "lineOrder", 1), out.add(uint8_t{0});
    out.attribute("pixelAspectRatio", "float", 4), out.add(1.0f);
    out.attribute("screenWindowCenter", "v2f", 8), out.add(0.0f), out.add(0.0f);
    out.attribute("screenWindowWidth", "float", 4), out.add(1.0f);
    out.add(uint8_t{0});
    const size_t table = out.all.size(); // where each line is
    out.all.resize(table + 8 * size_t{height});
    std::vector<uint16_t> line(4 * size_t{width});
    std::vector<uint8_t> prepared, packed;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const glm::vec4 pixel = glm::clamp(pixels[size_t{y} * width + x], -kMostHalf, kMostHalf);
            for (uint32_t c = 0; c < 4; ++c) line[c * width + x] = glm::packHalf1x16(pixel[int(3 - c)]);
        }
        const std::span raw(reinterpret_cast<const uint8_t*>(line.data()), line.size() * sizeof line[0]);
        prepare(raw, prepared);
        uLongf size = compressBound(uLong(prepared.size()));
        packed.resize(size);
        if (compress(packed.data(), &size, prepared.data(), uLong(prepared.size())) != Z_OK)
            throw std::runtime_error("OpenEXR: zlib does not compress");
        const uint64_t at = out.all.size();
        std::memcpy(out.all.data() + table + 8 * size_t{y}, &at, sizeof at);
        const bool smaller = size < raw.size(); // else the line stands as it is
        const std::span<const uint8_t> kept = smaller ? std::span<const uint8_t>(packed).first(size) : raw;
        out.add(int32_t(y)), out.add(int32_t(kept.size()));
        out.all.insert(out.all.end(), kept.begin(), kept.end());
    }
    return std::move(out.all);
}

} // namespace brume

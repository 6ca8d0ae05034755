// A finished picture as JPEG wants it: planes of full-range BT.601 Y, Cb, Cr bytes with 4:2:0 chroma. Or, for pictures
// that rest, with all of its colour: planes of sRGB R, G, B bytes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace brume {

struct PlaneLayout {
    uint32_t width = 0, height = 0;
    bool full = false; // R, G, B of every pixel, each as the plane of Y is laid out
    constexpr uint32_t lumaStride() const { return (width + 7) / 8 * 8; } // bytes
    uint32_t chromaStride() const { return lumaStride() / 2; }
    uint32_t chromaHeight() const { return (height + 1) / 2; }
    constexpr size_t lumaBytes() const { return size_t(lumaStride()) * height; }
    size_t chromaBytes() const { return size_t(chromaStride()) * chromaHeight(); }
    size_t bytes() const { return lumaBytes() + 2 * (full ? lumaBytes() : chromaBytes()); }
};

struct PictureView {
    PlaneLayout layout;
    const uint8_t* bytes = nullptr; // layout.bytes() of them: Y, Cb, Cr, or R, G, B
};

} // namespace brume

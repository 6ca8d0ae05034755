// Framing of brume.v1. One binary WebSocket message is a size-prefixed FlatBuffer (u32 little-endian length,
// identifier "BRM1"). In a frame message, the JPEG bytes of each view follow. See protocol/README.md.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/brume_generated.h"

namespace brume::wire {

inline constexpr char kSubprotocol[] = "brume.v1";
inline constexpr uint32_t kMaxViews = 2;
inline constexpr uint32_t kMaxLayers = 8;
inline constexpr uint32_t kLayerPictures = 3; // of a view: DepthLayers.bytes

// A verified message. It points into the bytes that it was parsed from, or into its own copy.
struct Parsed {
    const Message* message;
    std::span<const uint8_t> jpeg;  // pictures of all views, or columns of LitParticles; empty of others
    std::vector<uint8_t> copy = {}; // of a FlatBuffer that was finished without its size: it begins aligned here

    Body type() const { return message->body_type(); }
    // The body as a T; null if it has another type.
    template <class T>
    const T* as() const {
        return type() == BodyTraits<T>::enum_value ? static_cast<const T*>(message->body()) : nullptr;
    }
    // JPEG bytes of one view. Precondition: the message is a frame, and view < jpeg_bytes()->size().
    std::span<const uint8_t> view(uint32_t view) const;
    // Bytes of one of DepthLayers.bytes of a view. Precondition: the frame has layers, and the numbers are below
    // theirs.
    std::span<const uint8_t> layerPicture(uint32_t view, uint32_t picture) const;
};

// Parses one message. Returns nothing unless the bytes are exactly one well-formed message of this schema: all
// offsets are inside, the body type is known, no bytes are left over, and the JPEG lengths of a frame add up to the
// bytes that follow. Values of numbers are not checked. The FlatBuffer may have been finished with its size, which is
// what FinishSizePrefixed does, or without, with the size put before it: the two differ in alignment. Precondition:
// bytes.data() is aligned to 8, as fresh heap memory is.
std::optional<Parsed> parse(std::span<const uint8_t> bytes);
// Why parse() returns nothing for these bytes, for people: a part of a line.
std::string whyNot(std::span<const uint8_t> bytes);

using Packed = flatbuffers::DetachedBuffer;

inline std::span<const uint8_t> bytesOf(const Packed& packed) { return {packed.data(), packed.size()}; }

namespace detail {
template <class Table>
Packed finish(flatbuffers::FlatBufferBuilder& builder, flatbuffers::Offset<Table> body) {
    FinishSizePrefixedMessageBuffer(builder, CreateMessage(builder, BodyTraits<Table>::enum_value, body.Union()));
    return builder.Release();
}
} // namespace detail

// Makes a message. `build` gets a builder, creates the body and returns its offset: pack([](auto& b) { return
// CreateAck(b, 7); }).
template <class Build>
Packed pack(Build&& build) {
    flatbuffers::FlatBufferBuilder builder(256);
    const auto body = build(builder);
    return detail::finish(builder, body);
}

} // namespace brume::wire

#include "protocol/message.h"

#include <cassert>
#include <utility>

namespace brume::wire {
namespace {

// Deepest: message, body, command. Widest: a scene state's pass times. More is not ours.
constexpr uint32_t kMaxDepth = 8, kMaxTables = 256;
// Length, root offset and identifier: less cannot be a message, and some verifiers read that far unasked.
constexpr size_t kMinBytes = 12;

bool lengthsAddUp(const Frame& frame, size_t jpeg_bytes) {
    const auto& lengths = *frame.jpeg_bytes();
    if (lengths.size() < 1 || lengths.size() > kMaxViews) return false;
    uint64_t sum = 0;
    for (const uint32_t length : lengths) sum += length;
    if (const auto* layers = frame.layers()) {
        if (layers->size() != lengths.size()) return false;
        for (const DepthLayers* view : *layers) {
            if (view->bytes()->size() != kLayerPictures) return false;
            for (const uint32_t length : *view->bytes()) sum += length;
        }
    }
    return sum == jpeg_bytes;
}

// Bytes of the FlatBuffer with the size before it; 0 if there are too few for that.
size_t lengthOf(std::span<const uint8_t> bytes) {
    if (bytes.size() < kMinBytes) return 0;
    return size_t{flatbuffers::ReadScalar<uint32_t>(bytes.data())} + sizeof(uint32_t);
}

template <bool with_size>
bool verified(std::span<const uint8_t> bytes) {
    if (bytes.size() < kMinBytes - (with_size ? 0 : sizeof(uint32_t))) return false;
    flatbuffers::Verifier verifier(bytes.data(), bytes.size(), kMaxDepth, kMaxTables);
    return with_size ? VerifySizePrefixedMessageBuffer(verifier) : VerifyMessageBuffer(verifier);
}

} // namespace

std::span<const uint8_t> Parsed::view(uint32_t view) const {
    const auto& lengths = *as<Frame>()->jpeg_bytes();
    assert(view < lengths.size());
    return jpeg.subspan(view == 0 ? 0 : lengths.Get(0), lengths.Get(view));
}

std::span<const uint8_t> Parsed::layerPicture(uint32_t view, uint32_t picture) const {
    size_t begin = 0;
    for (const uint32_t length : *as<Frame>()->jpeg_bytes()) begin += length;
    const auto& layers = *as<Frame>()->layers();
    for (uint32_t i = 0; i <= view; ++i)
        for (uint32_t k = 0; k < kLayerPictures && !(i == view && k == picture); ++k)
            begin += layers.Get(i)->bytes()->Get(k);
    return jpeg.subspan(begin, layers.Get(view)->bytes()->Get(picture));
}

std::optional<Parsed> parse(std::span<const uint8_t> bytes) {
    assert(reinterpret_cast<uintptr_t>(bytes.data()) % 8 == 0);
    const size_t length = lengthOf(bytes);
    if (length < kMinBytes || length > bytes.size()) return {};

    Parsed parsed{nullptr, bytes.subspan(length)};
    if (verified<true>(bytes.first(length))) {
        parsed.message = GetSizePrefixedMessage(bytes.data());
    } else {
        parsed.copy.assign(bytes.begin() + sizeof(uint32_t), bytes.begin() + ptrdiff_t(length));
        if (!verified<false>(parsed.copy)) return {};
        parsed.message = GetMessage(parsed.copy.data());
    }
    if (parsed.type() == Body::NONE || parsed.type() > Body::MAX) return {};
    if (const auto* input = parsed.as<Input>();
        input && (input->command_type() == Command::NONE || input->command_type() > Command::MAX))
        return {};
    const auto* frame = parsed.as<Frame>();
    const auto* lit = parsed.as<LitParticles>();
    const bool whole =
        frame ? lengthsAddUp(*frame, parsed.jpeg.size()) : parsed.jpeg.size() == (lit ? lit->bytes() : 0);
    return whole ? std::optional(std::move(parsed)) : std::nullopt;
}

std::string whyNot(std::span<const uint8_t> bytes) {
    if (bytes.size() < kMinBytes) return "it has " + std::to_string(bytes.size()) + " bytes, a message at least 12";
    const size_t length = lengthOf(bytes);
    if (length < kMinBytes || length > bytes.size())
        return "its first four bytes say that " + std::to_string(length - sizeof(uint32_t)) + " follow, there are " +
               std::to_string(bytes.size() - sizeof(uint32_t));
    if (!flatbuffers::BufferHasIdentifier(bytes.data(), MessageIdentifier(), true))
        return "its FlatBuffer has not the identifier BRM1";
    return "its FlatBuffer is damaged, of a newer schema, or followed by other bytes";
}

} // namespace brume::wire

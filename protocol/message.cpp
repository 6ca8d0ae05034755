#include "protocol/message.h"

#include <cassert>

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
    return sum == jpeg_bytes;
}

} // namespace

std::span<const uint8_t> Parsed::view(uint32_t view) const {
    const auto& lengths = *as<Frame>()->jpeg_bytes();
    assert(view < lengths.size());
    return jpeg.subspan(view == 0 ? 0 : lengths.Get(0), lengths.Get(view));
}

std::optional<Parsed> parse(std::span<const uint8_t> bytes) {
    assert(reinterpret_cast<uintptr_t>(bytes.data()) % 8 == 0);
    if (bytes.size() < kMinBytes) return {};
    const size_t length = size_t{flatbuffers::ReadScalar<uint32_t>(bytes.data())} + sizeof(uint32_t);
    if (length < kMinBytes || length > bytes.size()) return {};

    flatbuffers::Verifier verifier(bytes.data(), length, kMaxDepth, kMaxTables);
    if (!VerifySizePrefixedMessageBuffer(verifier)) return {};

    const Parsed parsed{GetSizePrefixedMessage(bytes.data()), bytes.subspan(length)};
    if (parsed.type() == Body::NONE || parsed.type() > Body::MAX) return {};
    if (const auto* input = parsed.as<Input>();
        input && (input->command_type() == Command::NONE || input->command_type() > Command::MAX))
        return {};
    if (const auto* frame = parsed.as<Frame>())
        return lengthsAddUp(*frame, parsed.jpeg.size()) ? std::optional(parsed) : std::nullopt;
    return parsed.jpeg.empty() ? std::optional(parsed) : std::nullopt;
}

} // namespace brume::wire

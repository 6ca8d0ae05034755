// Counts WebSocket frames that are no message: pings, pongs and fragments.
#pragma once

#include <cstdint>
#include <utility>

namespace brume::net {

// Beast hands over whole messages and tells of control frames, but not of fragments, of which empty ones are never
// seen. Each takes at least six bytes beside its content. So bytes that neither messages nor control frames explain,
// nor one message that is being read, are counted as fragments.
class MereFrames {
public:
    // `max_message`: bytes of a message; `before`: bytes received before the first frame.
    MereFrames(uint64_t max_message, uint64_t before)
        : allowance_(frameBytes(max_message) + kReadAhead), explained_(before) {}

    void message(uint64_t bytes) { explained_ += frameBytes(bytes); }
    void control(uint64_t bytes) {
        ++count_;
        explained_ += frameBytes(bytes);
    }
    // How many came since the last call; `received`: bytes so far.
    uint64_t take(uint64_t received) {
        if (received > explained_ + allowance_) {
            const uint64_t fragments = (received - explained_ - allowance_) / kLeastFrame;
            count_ += fragments;
            explained_ += fragments * kLeastFrame;
        }
        return std::exchange(count_, 0);
    }

private:
    static constexpr uint64_t kLeastFrame = 6;      // bytes of a client's frame without content (RFC 6455, 5.2)
    static constexpr uint64_t kReadAhead = 8 << 10; // bytes; Beast reads 4 KiB ahead
    // Bytes of a client's frame with this content.
    static uint64_t frameBytes(uint64_t content) {
        return kLeastFrame + (content > 125 ? 2 : 0) + (content > 0xffff ? 6 : 0) + content;
    }
    const uint64_t allowance_;
    uint64_t explained_, count_ = 0;
};

} // namespace brume::net

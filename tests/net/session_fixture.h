// SessionTest: fixture and helpers of the tests of a viewer's session.
#pragma once

#include "tests/net/fixture.h"

namespace brume::test {

struct SessionTest : ServerTest {};

// The code of the next error message. Frames before it are acknowledged.
inline wire::ErrorCode nextError(WsClient& client) {
    while (const auto message = client.receive()) {
        if (!message->parsed) continue;
        if (const auto* frame = message->parsed->as<wire::Frame>()) client.ack(frame->id());
        if (const auto* error = message->parsed->as<wire::Error>()) return error->code();
    }
    ADD_FAILURE() << "no error came";
    return wire::ErrorCode(0);
}

// Acknowledges frames until one answers the pose, and returns it; null if none comes in time.
inline std::unique_ptr<Received> frameOf(WsClient& client, uint32_t pose_seq) {
    for (int i = 0; i < 1000; ++i) {
        auto message = client.next<wire::Frame>();
        if (!message) return nullptr;
        const auto* frame = message->parsed->as<wire::Frame>();
        client.ack(frame->id());
        if (frame->pose_seq() == pose_seq) return message;
    }
    return nullptr;
}

} // namespace brume::test

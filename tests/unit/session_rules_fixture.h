// SessionRulesTest: a session with its own clock. Helpers send messages and return the actions.
#pragma once

#include <limits>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "server/net/session_rules.h"

namespace brume::net {

using namespace std::chrono_literals;
using flatbuffers::FlatBufferBuilder;

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

struct PoseFields {
    uint32_t seq = 1;
    wire::Vec3 position{0, 0, 10};
    wire::Quat orientation{0, 0, 0, 1};
    float fov_y = 0.8f, eyes = 0;
    uint16_t width = 0, height = 0;
    std::optional<wire::Frustum> frustum{}, right_frustum{};
    bool hidden = false;
    const char* view = nullptr; // null: it is left out
    uint8_t layers = 0;
};

class SessionRulesTest : public testing::Test {
protected:
    NetOptions options;
    ServerFacts facts{"device", {"sphere", "isv"}};
    Clock::time_point now{1000s};
    std::optional<SessionRules> rules;

    void SetUp() override { rules.emplace(options, facts, now); }

    Actions sayBytes(std::vector<uint8_t> bytes) {
        Actions out;
        rules->onMessage(bytes, now, out);
        return out;
    }
    Actions tick(Clock::duration later) {
        now += later;
        Actions out;
        rules->onTick(now, out);
        return out;
    }
    template <class Build>
    Actions say(Build&& build) {
        const wire::Packed message = wire::pack(build);
        Actions out;
        rules->onMessage(wire::bytesOf(message), now, out);
        return out;
    }

    Actions hello(uint16_t width = 640, uint16_t height = 360, uint8_t views = 1, uint8_t quality = 0) {
        return say(
            [&](FlatBufferBuilder& b) { return wire::CreateHelloDirect(b, "test", width, height, views, quality); });
    }
    Actions pose(const PoseFields& p) {
        return say([&](FlatBufferBuilder& b) {
            return wire::CreatePoseDirect(b, p.seq, 77, &p.position, &p.orientation, p.fov_y, p.eyes, p.width, p.height,
                                          p.frustum ? &*p.frustum : nullptr,
                                          p.right_frustum ? &*p.right_frustum : nullptr, p.hidden, p.view, p.layers);
        });
    }
    template <class Build>
    Actions input(uint32_t seq, Build&& build) {
        return say([&](FlatBufferBuilder& b) {
            const auto command = build(b);
            using Table = std::remove_pointer_t<decltype(flatbuffers::GetTemporaryPointer(b, command))>;
            return wire::CreateInput(b, seq, 0, wire::CommandTraits<std::remove_const_t<Table>>::enum_value,
                                     command.Union());
        });
    }
    Actions restart(uint32_t seq) {
        return input(seq, [](FlatBufferBuilder& b) { return wire::CreateRestart(b); });
    }
    void watch() { ASSERT_EQ(hello().size(), 1u); }
};

// The only action of a message, which must be a T.
template <class T>
const T& only(const Actions& actions) {
    static const T none{};
    EXPECT_EQ(actions.size(), 1u);
    if (actions.size() != 1 || !std::holds_alternative<T>(actions[0])) {
        ADD_FAILURE() << "another action, index " << (actions.empty() ? 99 : actions[0].index());
        return none;
    }
    return std::get<T>(actions[0]);
}

inline wire::ErrorCode onlyError(const Actions& actions) {
    const auto& error = only<SendError>(actions);
    EXPECT_FALSE(error.text.empty());
    return error.code;
}

} // namespace brume::net

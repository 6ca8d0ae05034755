// What a viewer may say when: the rules alone, without sockets and with a clock of the test's own.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "server/net/session_rules.h"

namespace brume::net {
namespace {

using namespace std::chrono_literals;
using flatbuffers::FlatBufferBuilder;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

struct PoseFields {
    uint32_t seq = 1;
    wire::Vec3 position{0, 0, 10};
    wire::Quat orientation{0, 0, 0, 1};
    float fov_y = 0.8f, eyes = 0;
    uint16_t width = 0, height = 0;
};

class SessionRulesTest : public testing::Test {
protected:
    NetOptions options;
    SceneFacts facts{"scene", "device", {}, {"sphere", "isv"}, {"simpson", "analytic"}};
    Clock::time_point now{1000s};
    std::optional<SessionRules> rules;

    void SetUp() override { rules.emplace(options, facts, now); }

    Effects sayBytes(std::vector<uint8_t> bytes) {
        Effects out;
        rules->onMessage(bytes, now, out);
        return out;
    }
    Effects tick(Clock::duration later) {
        now += later;
        Effects out;
        rules->onTick(now, out);
        return out;
    }
    template <class Build>
    Effects say(Build&& build) {
        const wire::Packed message = wire::pack(build);
        Effects out;
        rules->onMessage(wire::bytesOf(message), now, out);
        return out;
    }

    Effects hello(uint16_t width = 640, uint16_t height = 360, uint8_t views = 1, uint8_t quality = 0) {
        return say([&](FlatBufferBuilder& b) { return wire::CreateHelloDirect(b, "test", width, height, views, quality); });
    }
    Effects pose(const PoseFields& p) {
        return say([&](FlatBufferBuilder& b) {
            return wire::CreatePose(b, p.seq, 77, &p.position, &p.orientation, p.fov_y, p.eyes, p.width, p.height);
        });
    }
    template <class Build>
    Effects input(uint32_t seq, Build&& build) {
        return say([&](FlatBufferBuilder& b) {
            const auto command = build(b);
            using Table = std::remove_pointer_t<decltype(flatbuffers::GetTemporaryPointer(b, command))>;
            return wire::CreateInput(b, seq, 0, wire::CommandTraits<std::remove_const_t<Table>>::enum_value, command.Union());
        });
    }
    Effects restart(uint32_t seq) {
        return input(seq, [](FlatBufferBuilder& b) { return wire::CreateRestart(b); });
    }
    void watch() { ASSERT_EQ(hello().size(), 1u); }
};

// The one effect, which must be of that kind.
template <class T>
const T& only(const Effects& effects) {
    static const T none{};
    EXPECT_EQ(effects.size(), 1u);
    if (effects.size() != 1 || !std::holds_alternative<T>(effects[0])) {
        ADD_FAILURE() << "another effect, index " << (effects.empty() ? 99 : effects[0].index());
        return none;
    }
    return std::get<T>(effects[0]);
}

wire::ErrorCode onlyError(const Effects& effects) {
    const auto& error = only<SendError>(effects);
    EXPECT_FALSE(error.text.empty());
    return error.code;
}

using wire::ErrorCode;

TEST_F(SessionRulesTest, AGoodHelloIsAdmitted) {
    const Effects effects = hello(1280, 720, 2, 90);
    const auto& admit = only<Admit>(effects);
    EXPECT_EQ(admit.client, "test");
    EXPECT_EQ(admit.wish.width, 1280);
    EXPECT_EQ(admit.wish.height, 720);
    EXPECT_EQ(admit.wish.views, 2);
    EXPECT_EQ(admit.wish.quality, 90);
}

TEST_F(SessionRulesTest, QualityZeroIsTheServers) {
    EXPECT_EQ(only<Admit>(hello(64, 64, 1, 0)).wish.quality, options.default_quality);
}

TEST_F(SessionRulesTest, AClientsNameIsMadeFitForTheLog) {
    const auto effects =
        say([](FlatBufferBuilder& b) { return wire::CreateHelloDirect(b, ("a\nb\x1b[31m" + std::string(500, 'x')).c_str()); });
    const std::string& name = only<Admit>(effects).client;
    EXPECT_EQ(name.substr(0, 8), "a?b?[31m");
    EXPECT_EQ(name.size(), 64u);
}

TEST_F(SessionRulesTest, AbsurdHellosAreRefusedAndMayBeSaidAgain) {
    EXPECT_EQ(onlyError(hello(0, 360)), ErrorCode::out_of_range);
    EXPECT_EQ(onlyError(hello(640, 0)), ErrorCode::out_of_range);
    EXPECT_EQ(onlyError(hello(640, 360, 0)), ErrorCode::out_of_range);
    EXPECT_EQ(onlyError(hello(640, 360, 3)), ErrorCode::out_of_range);
    EXPECT_EQ(onlyError(hello(640, 360, 1, 101)), ErrorCode::out_of_range);
    only<Admit>(hello());
}

TEST_F(SessionRulesTest, SizesAreFittedWithTheirAspect) {
    const auto granted = [&](uint16_t width, uint16_t height) {
        SetUp();
        const auto wish = only<Admit>(hello(width, height)).wish;
        return std::pair<int, int>(wish.width, wish.height);
    };
    EXPECT_EQ(granted(1920, 1080), std::pair(1920, 1080));
    EXPECT_EQ(granted(1080, 1920), std::pair(1080, 1920));
    EXPECT_EQ(granted(1, 1), std::pair(16, 16));
    for (const auto& [width, height] : {std::pair<uint16_t, uint16_t>{3840, 2160}, {65535, 65535}, {65535, 400}}) {
        const auto [w, h] = granted(width, height);
        EXPECT_LE(uint32_t(w * h), options.max_pixels);
        EXPECT_LE(std::max(w, h), options.max_side);
        EXPECT_GE(std::min(w, h), kMinSide);
        EXPECT_NEAR(double(w) / h, double(width) / height, 0.05 * double(width) / height);
    }
}

TEST_F(SessionRulesTest, NothingButPingsAndGoodbyesBeforeHello) {
    EXPECT_EQ(onlyError(pose({})), ErrorCode::unexpected);
    EXPECT_EQ(onlyError(restart(1)), ErrorCode::unexpected);
    EXPECT_EQ(onlyError(say([](auto& b) { return wire::CreateAck(b, 1); })), ErrorCode::unexpected);
    const auto ping = say([](auto& b) { return wire::CreatePing(b, 5, 6); });
    EXPECT_EQ(only<AnswerPing>(ping).nonce, 5u);
    EXPECT_EQ(only<AnswerPing>(ping).time_us, 6u);
    EXPECT_EQ(only<Close>(say([](auto& b) { return wire::CreateGoodbye(b); })).code, kCloseNormal);
}

TEST_F(SessionRulesTest, AHelloMustComeInTime) {
    EXPECT_TRUE(tick(options.handshake - 1ms).empty());
    EXPECT_EQ(only<Close>(tick(1ms)).code, kClosePolicy);
    EXPECT_TRUE(tick(1s).empty()) << "closed once";
    EXPECT_TRUE(hello().empty()) << "nothing follows a close";
    SetUp();
    watch();
    EXPECT_TRUE(tick(options.handshake + 1s).empty());
}

TEST_F(SessionRulesTest, HelloTwiceAndTheServersMessagesAreUnexpected) {
    watch();
    EXPECT_EQ(onlyError(hello()), ErrorCode::unexpected);
    EXPECT_EQ(onlyError(say([](auto& b) { return wire::CreateSceneState(b); })), ErrorCode::unexpected);
    EXPECT_EQ(onlyError(say([](auto& b) { return wire::CreateError(b); })), ErrorCode::unexpected);
    EXPECT_TRUE(say([](auto& b) { return wire::CreatePong(b, 1, 1); }).empty());
}

TEST_F(SessionRulesTest, APoseIsShownWithEverythingItSays) {
    watch();
    const auto effects = pose({.seq = 9, .position = {1, 2, 3}, .orientation = {0, 0.6f, 0, 0.8f}, .fov_y = 1, .eyes = 0.06f});
    const PoseRequest& request = only<Show>(effects).request;
    EXPECT_EQ(request.seq, 9u);
    EXPECT_EQ(request.client_time_us, 77u);
    EXPECT_EQ(request.pose.position, glm::vec3(1, 2, 3));
    EXPECT_FLOAT_EQ(request.pose.orientation.y, 0.6f);
    EXPECT_FLOAT_EQ(request.pose.orientation.w, 0.8f);
    EXPECT_EQ(request.pose.fov_y, 1);
    EXPECT_EQ(request.pose.eye_separation, 0.06f);
    EXPECT_EQ(request.received, now);
    EXPECT_EQ(request.width, 640);
}

TEST_F(SessionRulesTest, APosesSizeStaysUntilAnotherComes) {
    watch();
    EXPECT_EQ(only<Show>(pose({.seq = 1, .width = 320, .height = 200})).request.width, 320);
    EXPECT_EQ(only<Show>(pose({.seq = 2})).request.height, 200);
    const auto effects = pose({.seq = 3, .width = 65535});
    EXPECT_LE(only<Show>(effects).request.width, options.max_side);
    EXPECT_EQ(only<Show>(pose({.seq = 4, .width = 2, .height = 2})).request.width, kMinSide);
}

TEST_F(SessionRulesTest, PosesThatCannotBeAreOutOfRange) {
    watch();
    const std::vector<PoseFields> bad{
        {.position = {kNan, 0, 0}},
        {.position = {0, kInf, 0}},
        {.position = {0, 0, 1e9f}},
        {.orientation = {0, 0, 0, 0}},
        {.orientation = {0, 0, 0, 2}},
        {.orientation = {kNan, 0, 0, 1}},
        {.fov_y = 0},
        {.fov_y = kNan},
        {.fov_y = 3.2f},
        {.fov_y = -1},
        {.eyes = kNan},
        {.eyes = -1},
        {.eyes = 1e6f},
    };
    for (size_t i = 0; i < bad.size(); ++i) EXPECT_EQ(onlyError(pose(bad[i])), ErrorCode::out_of_range) << i;
    only<Show>(pose({}));
}

TEST_F(SessionRulesTest, PosesOverTheRateWaitAndTheNewestIsShown) {
    watch();
    size_t shown = 0, complaints = 0;
    const uint32_t sent = 2000; // at once
    for (uint32_t seq = 1; seq <= sent; ++seq)
        for (const Effect& effect : pose({.seq = seq})) {
            if (std::holds_alternative<Show>(effect))
                ++shown;
            else if (std::get<SendError>(effect).code == ErrorCode::too_fast)
                ++complaints;
        }
    EXPECT_EQ(shown, size_t(options.pose_rate * options.burst_s));
    EXPECT_EQ(complaints, 1u) << "one a second, not one a pose";
    EXPECT_EQ(only<Show>(tick(100ms)).request.seq, sent);
    EXPECT_TRUE(tick(100ms).empty());
    // An older one that comes late does not replace the one that waits.
    now += 10s;
    for (uint32_t seq = 1; seq <= 600; ++seq) pose({.seq = sent + seq});
    pose({.seq = 3});
    EXPECT_EQ(only<Show>(tick(100ms)).request.seq, sent + 600);
}

TEST_F(SessionRulesTest, TooManyMessagesMakeUsReadMoreSlowly) {
    watch();
    EXPECT_EQ(rules->pause(now), 0ns);
    for (double i = 0; i < options.message_rate * options.burst_s; ++i) say([](auto& b) { return wire::CreatePong(b, 1, 1); });
    const auto pause = rules->pause(now);
    EXPECT_GT(pause, 0ns);
    EXPECT_LE(pause, 1ms);
    EXPECT_EQ(rules->pause(now + pause + 1us), 0ns);
}

TEST_F(SessionRulesTest, InputsComeOneAfterAnother) {
    watch();
    EXPECT_EQ(only<Push>(restart(7)).seq, 7u) << "any number may be the first";
    only<Push>(restart(8));
    const auto repeated = restart(8);
    EXPECT_EQ(onlyError(repeated), ErrorCode::unexpected);
    EXPECT_EQ(only<SendError>(repeated).input_seq, 8u);
    only<Push>(restart(9));
    EXPECT_EQ(onlyError(restart(12)), ErrorCode::unexpected) << "a gap is told ...";
    only<Push>(restart(13)); // ... and gone on from
    SetUp();
    watch();
    only<Push>(restart(0xffffffff));
    only<Push>(restart(0)); // around the wrap
    EXPECT_EQ(onlyError(restart(0xffffffff)), ErrorCode::unexpected);
    only<Push>(restart(1));
}

TEST_F(SessionRulesTest, InputsOverTheRateAreRefusedByNumber) {
    watch();
    uint32_t seq = 0;
    for (double i = 0; i < options.input_rate * options.burst_s; ++i) only<Push>(restart(++seq));
    const auto refused = restart(++seq);
    EXPECT_EQ(onlyError(refused), ErrorCode::too_fast);
    EXPECT_EQ(only<SendError>(refused).input_seq, seq);
    now += 1s;
    only<Push>(restart(++seq)); // the refused number was used: the next one follows it
}

TEST_F(SessionRulesTest, CommandsArriveAsTheyWereSent) {
    watch();
    const wire::Vec3 origin(1, 2, 3), along(0, 0, -4), push(0, 5, 0);
    const auto impulse =
        std::get<Impulse>(only<Push>(input(1, [&](auto& b) { return wire::CreateImpulse(b, &origin, &along, &push, 2); })).body);
    EXPECT_EQ(impulse.origin, glm::vec3(1, 2, 3));
    EXPECT_EQ(impulse.direction, glm::vec3(0, 0, -1)) << "made a unit vector";
    EXPECT_EQ(impulse.push, glm::vec3(0, 5, 0));
    EXPECT_EQ(impulse.strength, 2);

    const auto light = std::get<SetLight>(only<Push>(input(2, [&](auto& b) { return wire::CreateSetLight(b, &push); })).body);
    EXPECT_EQ(light.to_light, glm::vec3(0, 1, 0));
    EXPECT_FALSE(light.irradiance);
    EXPECT_FALSE(light.rotate);

    const auto medium = std::get<SetMedium>(only<Push>(input(3, [](auto& b) { return wire::CreateSetMedium(b, 20.f); })).body);
    EXPECT_EQ(medium.extinction, 20);
    EXPECT_FALSE(medium.falloff);
    EXPECT_FALSE(medium.albedo);

    const auto render = std::get<SetRender>(
        only<Push>(input(4, [](auto& b) { return wire::CreateSetRenderDirect(b, "isv", "analytic", 3); })).body);
    EXPECT_EQ(render.method, "isv");
    EXPECT_EQ(render.quadrature, "analytic");
    EXPECT_EQ(render.steps, 3u);
    EXPECT_FALSE(render.exposure);

    const auto paused =
        std::get<SetSimulation>(only<Push>(input(5, [](auto& b) { return wire::CreateSetSimulation(b, true); })).body);
    EXPECT_EQ(paused.paused, true);
    const auto moved =
        std::get<MoveVolume>(only<Push>(input(6, [&](auto& b) { return wire::CreateMoveVolume(b, &origin); })).body);
    EXPECT_EQ(moved.offset, glm::vec3(1, 2, 3));
}

TEST_F(SessionRulesTest, CommandsBeyondTheirLimitsAreRefused) {
    watch();
    uint32_t seq = 0;
    const wire::Vec3 zero(0, 0, 0), one(1, 1, 1), nan(0, kNan, 0), far(1e9f, 0, 0), negative(-1, 0, 0), two(2, 0, 0);
    const auto refused = [&](auto&& build) {
        const auto effects = input(++seq, build);
        EXPECT_EQ(only<SendError>(effects).input_seq, seq);
        return onlyError(effects);
    };
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &nan, &one); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &zero); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &nan); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &one, &far); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &one, nullptr, 11); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateImpulse(b, &one, &one, nullptr, kNan); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateMoveVolume(b, &far); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetLight(b, &zero); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetLight(b, nullptr, &negative); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetLight(b, nullptr, nullptr, kInf); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetMedium(b, -1.f); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetMedium(b, {}, 0.f); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetMedium(b, {}, {}, 1.5f); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetMedium(b, {}, {}, {}, 1.f); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetMedium(b, {}, {}, {}, {}, &two); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetRenderDirect(b, nullptr, nullptr, 0u); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetRenderDirect(b, nullptr, nullptr, 11u); }), ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetRenderDirect(b, nullptr, nullptr, {}, 0.f); }),
              ErrorCode::out_of_range);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetRenderDirect(b, "tetra"); }), ErrorCode::unknown_name);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetRenderDirect(b, "", nullptr); }), ErrorCode::unknown_name);
    EXPECT_EQ(refused([&](auto& b) { return wire::CreateSetRenderDirect(b, "isv", "euler"); }), ErrorCode::unknown_name);
}

TEST_F(SessionRulesTest, AnUnknownNameIsToldWhatThereIs) {
    watch();
    const auto effects = input(1, [&](auto& b) { return wire::CreateSetRenderDirect(b, "tetra"); });
    EXPECT_NE(only<SendError>(effects).text.find("sphere, isv"), std::string::npos);
}

TEST_F(SessionRulesTest, AcknowledgingIsPassedOnAndAnUnknownFrameIsTold) {
    watch();
    EXPECT_EQ(only<Acknowledge>(say([](auto& b) { return wire::CreateAck(b, 41); })).frame, 41u);
    Effects out;
    rules->onUnknownFrame(41, now, out);
    EXPECT_EQ(onlyError(out), ErrorCode::unexpected);
}

TEST_F(SessionRulesTest, AFewMalformedMessagesEndIt) {
    watch();
    EXPECT_EQ(onlyError(sayBytes({1, 2, 3})), ErrorCode::malformed);
    Effects out;
    rules->onText(now, out);
    EXPECT_EQ(onlyError(out), ErrorCode::malformed);
    only<Show>(pose({})); // survived so far
    const auto last = sayBytes(std::vector<uint8_t>(100, 0xff));
    ASSERT_EQ(last.size(), 2u);
    EXPECT_EQ(std::get<SendError>(last[0]).code, ErrorCode::malformed);
    EXPECT_EQ(std::get<Close>(last[1]).code, kCloseProtocol);
    EXPECT_TRUE(pose({.seq = 2}).empty());
    EXPECT_TRUE(sayBytes({1}).empty());
}

TEST_F(SessionRulesTest, OneThatSendsNothingGoodIsClosed) {
    watch();
    size_t errors = 0;
    for (int i = 0; i < 100000; ++i)
        for (const Effect& effect : hello())
            if (std::holds_alternative<SendError>(effect))
                ++errors;
            else
                EXPECT_EQ(std::get<Close>(effect).code, kClosePolicy);
    EXPECT_GT(errors, 100u);
    EXPECT_LT(errors, 300u);
}

TEST(TokenBucketTest, FillsWithTimeUpToItsBurst) {
    TokenBucket bucket(10, 3);
    Clock::time_point now{5s};
    EXPECT_TRUE(bucket.take(now));
    EXPECT_TRUE(bucket.take(now));
    EXPECT_TRUE(bucket.take(now));
    EXPECT_FALSE(bucket.take(now));
    EXPECT_NEAR(std::chrono::duration<double>(bucket.wait(now)).count(), 0.1, 1e-6);
    EXPECT_FALSE(bucket.take(now + 90ms));
    EXPECT_TRUE(bucket.take(now + 101ms));
    EXPECT_FALSE(bucket.take(now)) << "a clock that goes back gives nothing";
    now += 1h;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(bucket.take(now));
    EXPECT_FALSE(bucket.take(now));
}

} // namespace
} // namespace brume::net

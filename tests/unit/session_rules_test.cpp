// What a viewer may say when: the rules alone, without sockets and with a clock of the test's own.
#include <algorithm>

#include "common/view_names.h"
#include "tests/unit/session_rules_fixture.h"

namespace brume::net {
namespace {

using wire::ErrorCode;

TEST_F(SessionRulesTest, AGoodHelloIsAdmitted) {
    const Actions actions = hello(1280, 720, 2, 90);
    const auto& admit = only<Admit>(actions);
    EXPECT_EQ(admit.client, "test");
    EXPECT_EQ(admit.granted.width, 1280);
    EXPECT_EQ(admit.granted.height, 720);
    EXPECT_EQ(admit.granted.views, 2);
    EXPECT_EQ(admit.granted.quality, 90);
}

TEST_F(SessionRulesTest, APoseFollowsHelloInTime) {
    watch();
    EXPECT_TRUE(tick(options.handshake - 1ms).empty());
    EXPECT_EQ(only<Close>(tick(1ms)).code, kClosePolicy);
}

TEST_F(SessionRulesTest, OnlyAGoodPoseCountsAndAHiddenOneDoes) {
    watch();
    onlyError(pose({.fov_y = kNan}));
    only<SetPose>(pose({.seq = 2, .hidden = true}));
    EXPECT_TRUE(tick(10 * options.handshake).empty());
    rules.emplace(options, facts, now);
    watch();
    onlyError(pose({.fov_y = kNan}));
    EXPECT_EQ(only<Close>(tick(options.handshake)).code, kClosePolicy);
}

TEST_F(SessionRulesTest, PingsAndFragmentsCountAsMessages) {
    watch();
    Actions out;
    const auto burst = uint64_t(options.message_rate * options.burst_s);
    rules->onMereFrames(burst, now, out);
    EXPECT_TRUE(out.empty());
    EXPECT_GT(rules->pause(now), 0ns) << "the next message is read later";
    now += 3600s;
    EXPECT_EQ(rules->pause(now), 0ns);
    rules->onMereFrames(2 * burst - 1, now, out);
    EXPECT_TRUE(out.empty());
    EXPECT_GE(rules->pause(now), std::chrono::duration<double>(options.burst_s)) << "owed";
    rules->onMereFrames(1, now, out);
    EXPECT_EQ(only<Close>(out).code, kClosePolicy);
}

TEST_F(SessionRulesTest, QualityZeroIsTheServers) {
    EXPECT_EQ(only<Admit>(hello(64, 64, 1, 0)).granted.quality, options.default_quality);
}

TEST_F(SessionRulesTest, AClientsNameIsMadeFitForTheLog) {
    const auto actions = say([](FlatBufferBuilder& b) {
        return wire::CreateHelloDirect(b, ("a\nb\x1b[31m" + std::string(500, 'x')).c_str());
    });
    const std::string& name = only<Admit>(actions).client;
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
        const auto size = only<Admit>(hello(width, height)).granted;
        return std::pair<int, int>(size.width, size.height);
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
    only<SetPose>(pose({}));
    EXPECT_TRUE(tick(options.handshake + 1s).empty());
}

TEST_F(SessionRulesTest, HelloTwiceAndTheServersMessagesAreUnexpected) {
    watch();
    EXPECT_EQ(onlyError(hello()), ErrorCode::unexpected);
    EXPECT_EQ(onlyError(say([](auto& b) { return wire::CreateSceneState(b); })), ErrorCode::unexpected);
    EXPECT_EQ(onlyError(say([](auto& b) { return wire::CreateError(b); })), ErrorCode::unexpected);
    EXPECT_EQ(only<Ponged>(say([](auto& b) { return wire::CreatePong(b, 9, 1); })).nonce, 9u);
}

TEST_F(SessionRulesTest, APoseIsShownWithEverythingItSays) {
    watch();
    const auto actions =
        pose({.seq = 9, .position = {1, 2, 3}, .orientation = {0, 0.6f, 0, 0.8f}, .fov_y = 1, .eyes = 0.06f});
    const PoseRequest& request = only<SetPose>(actions).request;
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

TEST_F(SessionRulesTest, AHiddenWindowIsHiddenUntilAPoseSaysOtherwise) {
    watch();
    EXPECT_FALSE(only<SetPose>(pose({.seq = 1})).request.hidden);
    EXPECT_TRUE(only<SetPose>(pose({.seq = 2, .hidden = true})).request.hidden);
    EXPECT_FALSE(only<SetPose>(pose({.seq = 3})).request.hidden);
}

TEST_F(SessionRulesTest, APoseMayAskHowThePictureIsMade) {
    watch();
    EXPECT_EQ(only<SetPose>(pose({.seq = 1})).request.show, 0);
    EXPECT_EQ(only<SetPose>(pose({.seq = 2, .view = "depth"})).request.show, *viewNamed("depth"));
    EXPECT_EQ(only<SetPose>(pose({.seq = 3, .view = "picture"})).request.show, 0);
    EXPECT_EQ(only<SetPose>(pose({.seq = 4})).request.show, 0); // each pose says it anew
    const SendError refusal = only<SendError>(pose({.seq = 5, .view = "depths"}));
    EXPECT_EQ(refusal.code, wire::ErrorCode::out_of_range);
    EXPECT_EQ(refusal.text, "no such view; there are picture wasted overdraw particles rays depth shadow light error");
    EXPECT_EQ(only<SetPose>(pose({.seq = 6, .view = "light"})).request.seq, 6u);
}

TEST_F(SessionRulesTest, APoseMayAskForLayers) {
    watch();
    EXPECT_EQ(only<SetPose>(pose({.seq = 1, .layers = 8})).request.layers, 8);
    EXPECT_EQ(only<SetPose>(pose({.seq = 2})).request.layers, 0) << "each pose says it anew";
    const SendError refusal = only<SendError>(pose({.seq = 3, .layers = 9}));
    EXPECT_EQ(refusal.code, wire::ErrorCode::out_of_range);
    EXPECT_EQ(refusal.text, "layers are 0 ... 8");
}

TEST_F(SessionRulesTest, APosesSizeStaysUntilAnotherComes) {
    watch();
    EXPECT_EQ(only<SetPose>(pose({.seq = 1, .width = 320, .height = 200})).request.width, 320);
    EXPECT_EQ(only<SetPose>(pose({.seq = 2})).request.height, 200);
    const auto actions = pose({.seq = 3, .width = 65535});
    EXPECT_LE(only<SetPose>(actions).request.width, options.max_side);
    EXPECT_EQ(only<SetPose>(pose({.seq = 4, .width = 2, .height = 2})).request.width, kMinSide);
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
        {.eyes = 10.01f},
    };
    for (size_t i = 0; i < bad.size(); ++i) EXPECT_EQ(onlyError(pose(bad[i])), ErrorCode::out_of_range) << i;
    only<SetPose>(pose({}));
}

TEST_F(SessionRulesTest, EyesMayBeAsFarApartAsTheLimitSays) {
    watch();
    EXPECT_EQ(only<SetPose>(pose({.seq = 1, .eyes = 10})).request.pose.eye_separation, 10);
    const auto refused = pose({.seq = 2, .eyes = 10.01f});
    EXPECT_NE(only<SendError>(refused).text.find("eye_separation in 0 ... 10 m"), std::string::npos);
}

TEST_F(SessionRulesTest, EyesHaveFrustaOfTheirOwn) {
    watch();
    const wire::Frustum left(1.2f, 0.9f, 1, 1.1f), right(0.9f, 1.2f, 1, 1.1f), aside(-0.5f, 1.5f, 1, -0.25f);
    const Pose pose_shown = only<SetPose>(pose({.seq = 1, .frustum = left, .right_frustum = right})).request.pose;
    EXPECT_EQ(pose_shown.frustum, (Frustum{1.2f, 0.9f, 1, 1.1f}));
    EXPECT_EQ(pose_shown.right_frustum, (Frustum{0.9f, 1.2f, 1, 1.1f}));
    EXPECT_EQ(only<SetPose>(pose({.seq = 2, .frustum = aside})).request.pose.frustum.left, -0.5f);
    EXPECT_EQ(only<SetPose>(pose({.seq = 3})).request.pose.frustum, Frustum{}) << "not kept from another pose";
}

TEST_F(SessionRulesTest, FrustaThatCannotBeAreOutOfRange) {
    watch();
    const std::vector<wire::Frustum> bad{
        {kNan, 1, 1, 1},  {1, kInf, 1, 1},    {1, 1, -kInf, 1}, {1, 1, 1, kNan},          {51, 1, 1, 1},
        {1, 1, 1, -1e6f}, {1, -1, 1, 1},      {1, 1, -1, 1},    {-1, 0.5f, 1, 1},         {1, 1, 0, 0},
        {0, 0, 1, 1},     {1, -0.995f, 1, 1}, {0, 0, 0, 1e-9f}, {3e38f, 3e38f, 3e38f, 0},
    };
    for (size_t i = 0; i < bad.size(); ++i) {
        EXPECT_EQ(onlyError(pose({.frustum = bad[i]})), ErrorCode::out_of_range) << i;
        EXPECT_EQ(onlyError(pose({.right_frustum = bad[i]})), ErrorCode::out_of_range) << i;
    }
    only<SetPose>(pose({.frustum = wire::Frustum(0, 0, 0, 0)})); // as if none were sent
}

TEST_F(SessionRulesTest, PosesOverTheRateWaitAndTheNewestIsShown) {
    watch();
    size_t shown = 0, complaints = 0;
    const uint32_t sent = 2000; // at once
    for (uint32_t seq = 1; seq <= sent; ++seq)
        for (const Action& action : pose({.seq = seq})) {
            if (std::holds_alternative<SetPose>(action))
                ++shown;
            else if (std::get<SendError>(action).code == ErrorCode::too_fast)
                ++complaints;
        }
    EXPECT_EQ(shown, size_t(options.pose_rate * options.burst_s));
    EXPECT_EQ(complaints, 1u) << "one a second, not one a pose";
    EXPECT_EQ(only<SetPose>(tick(100ms)).request.seq, sent);
    EXPECT_TRUE(tick(100ms).empty());
    // An older one that comes late does not replace the one that waits.
    now += 10s;
    for (uint32_t seq = 1; seq <= 600; ++seq) pose({.seq = sent + seq});
    pose({.seq = 3});
    EXPECT_EQ(only<SetPose>(tick(100ms)).request.seq, sent + 600);
}

TEST_F(SessionRulesTest, TooManyMessagesMakeUsReadMoreSlowly) {
    watch();
    EXPECT_EQ(rules->pause(now), 0ns);
    for (double i = 0; i < options.message_rate * options.burst_s; ++i)
        say([](auto& b) { return wire::CreatePong(b, 1, 1); });
    const auto pause = rules->pause(now);
    EXPECT_GT(pause, 0ns);
    EXPECT_LE(pause, 1ms);
    EXPECT_EQ(rules->pause(now + pause + 1us), 0ns);
}

TEST_F(SessionRulesTest, AcknowledgingIsPassedOnAndAnUnknownFrameIsTold) {
    watch();
    EXPECT_EQ(only<Acknowledge>(say([](auto& b) { return wire::CreateAck(b, 41); })).frame, 41u);
    Actions out;
    rules->onUnknownFrame(41, now, out);
    EXPECT_EQ(onlyError(out), ErrorCode::unexpected);
}

TEST_F(SessionRulesTest, AFewMalformedMessagesEndIt) {
    watch();
    EXPECT_EQ(onlyError(sayBytes({1, 2, 3})), ErrorCode::malformed);
    Actions out;
    rules->onText(now, out);
    EXPECT_EQ(onlyError(out), ErrorCode::malformed);
    only<SetPose>(pose({})); // survived so far
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
        for (const Action& action : hello())
            if (std::holds_alternative<SendError>(action))
                ++errors;
            else
                EXPECT_EQ(std::get<Close>(action).code, kClosePolicy);
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

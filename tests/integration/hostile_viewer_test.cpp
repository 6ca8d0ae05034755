// What a broken or ill-meaning viewer sends is answered, and harms nobody.
#include <limits>

#include <gtest/gtest.h>

#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/net/set_message.h"

namespace brume::test {
namespace {

using client::Bytes;
using client::Connection;
using wire::ErrorCode;

// A viewer that says what it likes.
class RawViewer {
public:
    explicit RawViewer(const client::Endpoint& server) : connection(server, kPatience) {
        while (connection.state() == Connection::State::connecting) connection.receive(kPatience);
        EXPECT_EQ(connection.state(), Connection::State::open) << connection.closedBecause();
    }

    template <class Build>
    void say(Build&& build) {
        connection.send(wire::bytesOf(wire::pack(build)));
    }
    void hello() {
        say([](auto& b) { return wire::CreateHello(b, b.CreateString("raw"), 320, 180, 1, 80); });
    }

    // The next error; what else comes is passed over. Nothing when the server closes first.
    std::optional<SeenError> error() {
        const auto deadline = std::chrono::steady_clock::now() + kPatience;
        while (std::chrono::steady_clock::now() < deadline) {
            const auto message = connection.receive(milliseconds(100));
            if (!message && connection.state() == Connection::State::closed) return {};
            if (!message) continue;
            const auto parsed = wire::parse(*message);
            if (!parsed) {
                ADD_FAILURE() << "the server sent what is not brume.v1";
                return {};
            }
            if (const auto* e = parsed->as<wire::Error>())
                return SeenError{e->code(), e->text() ? e->text()->str() : "", e->input_seq()};
        }
        return {};
    }
    // Whether the server still talks to us after what was said so far.
    bool answersPing() {
        ++ping_;
        say([&](auto& b) { return wire::CreatePing(b, ping_, 1); });
        const auto deadline = std::chrono::steady_clock::now() + kPatience;
        while (connection.state() != Connection::State::closed && std::chrono::steady_clock::now() < deadline)
            if (const auto message = connection.receive(milliseconds(100)))
                if (const auto parsed = wire::parse(*message))
                    if (const auto* pong = parsed->as<wire::Pong>(); pong && pong->nonce() == ping_) return true;
        EXPECT_EQ(connection.state(), Connection::State::closed) << "the server says nothing any more";
        return false;
    }
    bool closedBySoon() {
        const auto deadline = std::chrono::steady_clock::now() + kPatience;
        while (connection.state() != Connection::State::closed && std::chrono::steady_clock::now() < deadline)
            connection.receive(milliseconds(100));
        return connection.state() == Connection::State::closed;
    }

    Connection connection;

private:
    uint32_t ping_ = 0;
};

// One server for all of these tests, and a viewer that watches throughout and must notice nothing.
class HostileViewer : public testing::Test {
protected:
    static void SetUpTestSuite() { server_ = new RunningServer; }
    static void TearDownTestSuite() {
        delete server_;
        server_ = nullptr;
    }
    void SetUp() override {
        bystander_ = std::make_unique<Watcher>(server());
        bystander_->look(lookAt({0, 2, 26}, {0, 0, 0}, 0.8f));
    }
    void TearDown() override {
        const size_t before = bystander_->frames.size();
        EXPECT_TRUE(watch({bystander_.get()}, [&] { return bystander_->frames.size() >= before + 3; }))
            << "the bystander gets no frames any more: " << bystander_->session.closedBecause();
        EXPECT_TRUE(bystander_->errors.empty());
    }
    static client::Endpoint server() { return server_->endpoint(); }

private:
    static inline RunningServer* server_ = nullptr;
    std::unique_ptr<Watcher> bystander_;
};

void expectError(RawViewer& viewer, ErrorCode code, uint32_t input_seq = 0) {
    const auto error = viewer.error();
    ASSERT_TRUE(error) << "closed: " << viewer.connection.closedBecause();
    EXPECT_EQ(wire::EnumNameErrorCode(error->code), std::string(wire::EnumNameErrorCode(code))) << error->text;
    EXPECT_EQ(error->input_seq, input_seq);
    EXPECT_FALSE(error->text.empty());
}

TEST_F(HostileViewer, NoiseIsAnsweredThenClosed) {
    RawViewer viewer(server());
    viewer.hello();
    const Bytes noise(100, 0xa5);
    viewer.connection.send(noise);
    expectError(viewer, ErrorCode::malformed);
    for (int i = 0; i < 10; ++i) viewer.connection.send(noise);
    EXPECT_TRUE(viewer.closedBySoon());
}

TEST_F(HostileViewer, EveryTruncationAndBitFlipOfAMessageIsSurvived) {
    const wire::Vec3 position(0, 2, 26);
    const wire::Quat orientation(0, 0, 0, 1);
    const auto pose =
        wire::pack([&](auto& b) { return wire::CreatePose(b, 1, 1, &position, &orientation, 0.8f, 0, 320, 180); });
    const auto bytes = wire::bytesOf(pose);
    std::vector<Bytes> broken;
    for (size_t length = 0; length < bytes.size(); length += 3)
        broken.emplace_back(bytes.begin(), bytes.begin() + std::ptrdiff_t(length));
    for (size_t bit = 0; bit < bytes.size() * 8; bit += 7) {
        broken.emplace_back(bytes.begin(), bytes.end());
        broken.back()[bit / 8] ^= static_cast<uint8_t>(1u << (bit % 8));
    }
    // The server closes after a few: as many connections as it takes. A flipped bit may also leave a good message.
    auto viewer = std::make_unique<RawViewer>(server());
    viewer->hello();
    size_t closed = 0;
    for (const Bytes& message : broken) {
        viewer->connection.send(message);
        if (viewer->answersPing()) continue;
        ++closed;
        viewer = std::make_unique<RawViewer>(server());
        viewer->hello();
    }
    EXPECT_GE(closed, broken.size() / 10);
}

TEST_F(HostileViewer, AnOversizedMessageClosesOnlyItsSender) {
    RawViewer viewer(server());
    viewer.hello();
    viewer.connection.send(Bytes(1u << 20, 0));
    EXPECT_TRUE(viewer.closedBySoon());
}

TEST_F(HostileViewer, ALengthThatLiesIsMalformed) {
    RawViewer viewer(server());
    viewer.hello();
    auto ack = wire::pack([](auto& b) { return wire::CreateAck(b, 1); });
    Bytes message(wire::bytesOf(ack).begin(), wire::bytesOf(ack).end());
    message[3] = 0x7f; // says that 2 GB follow
    viewer.connection.send(message);
    expectError(viewer, ErrorCode::malformed);
}

TEST_F(HostileViewer, MessagesOutOfOrderAreAnswered) {
    RawViewer viewer(server());
    const wire::Vec3 position(0, 2, 26);
    const wire::Quat orientation(0, 0, 0, 1);
    const auto pose = [&](auto& b) { return wire::CreatePose(b, 1, 1, &position, &orientation); };
    viewer.say(pose);
    expectError(viewer, ErrorCode::unexpected); // before hello
    viewer.say([](auto& b) { return wire::CreateAck(b, 1); });
    expectError(viewer, ErrorCode::unexpected);
    viewer.hello();
    viewer.hello();
    expectError(viewer, ErrorCode::unexpected); // twice
    viewer.say([](auto& b) { return wire::CreateError(b, ErrorCode::full, b.CreateString("I am a server")); });
    expectError(viewer, ErrorCode::unexpected);
    viewer.say([](auto& b) { return wire::CreateAck(b, 4711); });
    expectError(viewer, ErrorCode::unexpected); // never sent
    const auto restart = [](uint32_t seq) {
        return [seq](auto& b) {
            return wire::CreateInput(b, seq, 1, wire::Command::Restart, wire::CreateRestart(b).Union());
        };
    };
    viewer.say(restart(1));
    viewer.say(restart(5));
    expectError(viewer, ErrorCode::unexpected, 5); // a gap
    viewer.say(restart(2));
    expectError(viewer, ErrorCode::unexpected, 2); // a repetition
    // After all that it may still watch.
    viewer.say(pose);
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    bool frame = false;
    while (!frame && std::chrono::steady_clock::now() < deadline)
        if (const auto message = viewer.connection.receive(milliseconds(100)))
            frame = wire::parse(*message).value().as<wire::Frame>() != nullptr;
    EXPECT_TRUE(frame) << viewer.connection.closedBecause();
}

TEST_F(HostileViewer, AnOlderPoseChangesNothing) {
    Watcher watcher(server());
    const auto say = [&](uint32_t seq, float x) {
        const wire::Vec3 position(x, 2, 26);
        const wire::Quat orientation(0, 0, 0, 1);
        watcher.session.connection().send(wire::bytesOf(
            wire::pack([&](auto& b) { return wire::CreatePose(b, seq, 1, &position, &orientation, 0.8f); })));
    };
    say(10, 1);
    ASSERT_TRUE(watch({&watcher}, [&] { return !watcher.frames.empty(); }));
    say(9, 2);
    say(10, 3);
    const size_t before = watcher.frames.size();
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= before + 6; }));
    for (const Seen& frame : watcher.frames) {
        EXPECT_EQ(frame.pose_seq, 10u);
        EXPECT_EQ(frame.position.x, 1);
    }
}

TEST_F(HostileViewer, NumbersBeyondTheirLimitsAreRefused) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    RawViewer viewer(server());
    viewer.hello();
    const wire::Vec3 here(0, 2, 26), nowhere(nan, 0, 0), forward(0, 0, -1), zero(0, 0, 0);
    const wire::Quat unit(0, 0, 0, 1), endless(0, 0, inf, 1), none(0, 0, 0, 0);
    viewer.say([&](auto& b) { return wire::CreatePose(b, 1, 1, &nowhere, &unit, 0.8f); });
    expectError(viewer, ErrorCode::out_of_range);
    viewer.say([&](auto& b) { return wire::CreatePose(b, 2, 1, &here, &endless, 0.8f); });
    expectError(viewer, ErrorCode::out_of_range);
    viewer.say([&](auto& b) { return wire::CreatePose(b, 3, 1, &here, &none, 0.8f); });
    expectError(viewer, ErrorCode::out_of_range);
    viewer.say([&](auto& b) { return wire::CreatePose(b, 4, 1, &here, &unit, 4.0f); });
    expectError(viewer, ErrorCode::out_of_range);
    uint32_t seq = 0;
    const auto impulse = [&](const wire::Vec3& origin, const wire::Vec3& direction, float strength) {
        ++seq;
        viewer.say([&](auto& b) {
            return wire::CreateInput(b, seq, 1, wire::Command::Impulse,
                                     wire::CreateImpulse(b, &origin, &direction, nullptr, strength).Union());
        });
    };
    impulse(nowhere, forward, 1);
    expectError(viewer, ErrorCode::out_of_range, 1);
    impulse(here, zero, 1);
    expectError(viewer, ErrorCode::out_of_range, 2);
    impulse(here, forward, inf);
    expectError(viewer, ErrorCode::out_of_range, 3);
    viewer.say([&](auto& b) {
        return wire::CreateInput(b, 4, 1, wire::Command::Set, test::set("render.method", "no such method")(b).Union());
    });
    expectError(viewer, ErrorCode::unknown_name, 4);
}

TEST_F(HostileViewer, AFloodOfInputsIsSlowed) {
    Watcher flood(server());
    for (int i = 0; i < 400; ++i) flood.session.sendImpulse({{0, 50, 0}, {0, 1, 0}, {0, 0, 0}, 0});
    EXPECT_TRUE(watch({&flood}, [&] { return flood.saw(ErrorCode::too_fast); }));
}

} // namespace
} // namespace brume::test

// Viewers that send rubbish or too much, stall, fall silent or vanish: told or cut, and nobody else's harm.
#include "tests/net/log_capture.h"
#include "tests/net/session_fixture.h"

namespace brume::test {
namespace {

using wire::ErrorCode;

TEST_F(SessionTest, BadMessagesAreAnsweredAndSurvived) {
    serve();
    const auto client = watch();
    const std::vector<uint8_t> garbage(200, 0x5a);
    client->sendMessage(2, garbage);
    EXPECT_EQ(nextError(*client), ErrorCode::malformed);
    client->sendMessage(1, std::vector<uint8_t>{'h', 'i'});
    EXPECT_EQ(nextError(*client), ErrorCode::malformed);
    client->pose(1, {std::numeric_limits<float>::quiet_NaN(), 0, 0});
    EXPECT_EQ(nextError(*client), ErrorCode::out_of_range);
    client->hello();
    EXPECT_EQ(nextError(*client), ErrorCode::unexpected);
    client->say([](auto& b) { return wire::CreateSceneState(b); });
    EXPECT_EQ(nextError(*client), ErrorCode::unexpected);
    client->pose(2);
    EXPECT_TRUE(frameOf(*client, 2)) << "still served";
    client->sendMessage(2, {});
    EXPECT_EQ(nextError(*client), ErrorCode::malformed);
    const auto goodbye = client->next<wire::Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(client->closeCode(), 1002);
    EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
}

TEST_F(SessionTest, APoseBeforeHelloIsUnexpectedAndHelloMayFollow) {
    WsClient client(serve());
    client.pose(1);
    EXPECT_EQ(nextError(client), ErrorCode::unexpected);
    client.hello(0, 0);
    EXPECT_EQ(nextError(client), ErrorCode::out_of_range);
    client.hello();
    EXPECT_TRUE(client.next<wire::Welcome>());
}

TEST_F(SessionTest, AnOversizedMessageClosesOnlyItsSender) {
    serve();
    const auto good = watch(), bad = watch();
    bad->sendMessage(2, std::vector<uint8_t>(options.max_message_bytes + 1));
    EXPECT_EQ(bad->closeCode(), 1009);
    good->pose(1);
    EXPECT_TRUE(frameOf(*good, 1));
    EXPECT_TRUE(eventually([&] { return audience->size() == 1; }));
}

// The device cannot draw what one viewer asks for: that viewer is told why and goes, the other one looks on.
TEST_F(SessionTest, WhoCannotBeDrawnIsToldAndGoes) {
    serve();
    const auto modest = watch(), greedy = watch();
    renderer->most_pixels = 640 * 360;
    modest->pose(1);
    EXPECT_TRUE(frameOf(*modest, 1));
    greedy->pose(1, {0, 0, 10}, 1280, 720);
    const auto error = greedy->next<wire::Error>();
    ASSERT_TRUE(error);
    EXPECT_EQ(error->parsed->as<wire::Error>()->code(), ErrorCode::out_of_range);
    EXPECT_EQ(error->parsed->as<wire::Error>()->text()->str(), "ask for smaller pictures");
    EXPECT_EQ(greedy->closeCode(), 1008);
    modest->pose(2);
    EXPECT_TRUE(frameOf(*modest, 2));
    for (const char* path : {"/snapshot.jpg", "/stream.mjpg"}) {
        const HttpAnswer answer = get(server->port(), std::string(path) + "?w=1280&h=720");
        EXPECT_EQ(answer.status, 400) << path;
        EXPECT_EQ(answer.body, "ask for smaller pictures\n");
    }
}

TEST_F(SessionTest, AFloodOfPosesHarmsNobodyAndItsLastIsShown) {
    serve();
    const auto quiet = watch(), loud = watch();
    quiet->pose(1);
    const uint32_t poses = 6000;
    std::thread flood([&] {
        for (uint32_t seq = 1; seq <= poses; ++seq)
            if (!loud->pose(seq)) return;
    });
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(frameOf(*quiet, 1));
    flood.join();
    bool shown = false, told = false;
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    while (!(shown && told) && std::chrono::steady_clock::now() < deadline) {
        const auto message = loud->receive();
        ASSERT_TRUE(message && message->parsed);
        if (const auto* frame = message->parsed->as<wire::Frame>()) {
            loud->ack(frame->id());
            shown |= frame->pose_seq() == poses;
        }
        if (const auto* error = message->parsed->as<wire::Error>()) told |= error->code() == ErrorCode::too_fast;
    }
    EXPECT_TRUE(shown);
    EXPECT_TRUE(told);
}

TEST_F(SessionTest, AStalledReaderDelaysNobody) {
    options.write_stall = 60s;
    serve();
    renderer->jpeg_bytes = 2 << 20; // two in flight are over what the sockets hold
    const auto stalled = watch(640, 360, 1, 4096), good = watch();
    stalled->pose(1);
    good->pose(1);
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(frameOf(*good, 1));
    EXPECT_EQ(audience->size(), 2u) << "the other still stalls";
}

TEST_F(SessionTest, AStalledReaderIsCut) {
    const LogCapture log;
    options.write_stall = 300ms;
    serve();
    renderer->jpeg_bytes = 2 << 20;
    const auto stalled = watch(640, 360, 1, 4096);
    stalled->pose(1);
    EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
    server.reset();
    EXPECT_EQ(log.atLeast(spdlog::level::warn), "") << "a laptop that sleeps is nothing to warn of";
}

TEST_F(SessionTest, WhoAsksButDoesNotReadIsNotReadAndCut) {
    options.message_rate = 1e6;
    options.write_stall = 300ms;
    serve();
    const auto client = watch(640, 360, 1, 4096);
    const wire::Packed ping = wire::pack([](auto& b) { return wire::CreatePing(b, 1, 1); });
    // Pongs fill the sockets, then pings do, until we are cut.
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    while (client->sendMessage(2, wire::bytesOf(ping), 60s) && std::chrono::steady_clock::now() < deadline) {
    }
    EXPECT_LT(std::chrono::steady_clock::now(), deadline);
    EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
}

TEST_F(SessionTest, ASlowHandshakeIsCut) {
    options.handshake = 300ms;
    const uint16_t port = serve();
    Socket dripping(port), silent(port);
    const auto start = std::chrono::steady_clock::now();
    std::thread drip([&] {
        for (const char c : std::string("GET /healthz HTTP/1.1\r\nHost: a-host-with-a-long-name\r\n")) {
            if (!dripping.send(std::string_view(&c, 1))) return;
            std::this_thread::sleep_for(20ms);
        }
    });
    EXPECT_TRUE(silent.closesWithin(2s));
    EXPECT_TRUE(dripping.closesWithin(2s));
    EXPECT_GE(std::chrono::steady_clock::now() - start, 250ms);
    drip.join();

    WsClient mute(port); // upgraded, but no hello
    ASSERT_EQ(mute.handshake.status, 101);
    const auto goodbye = mute.next<wire::Goodbye>(2s);
    ASSERT_TRUE(goodbye);
    EXPECT_NE(goodbye->parsed->as<wire::Goodbye>()->reason()->str().find("Hello"), std::string::npos);
    EXPECT_EQ(mute.closeCode(), 1008);
}

// A hello alone holds a place, so it is not enough.
TEST_F(SessionTest, AHelloWithoutAPoseIsCutAndAHiddenViewerIsNot) {
    options.handshake = 400ms;
    serve();
    const auto mute = watch(), hidden = watch();
    hidden->pose(1, {0, 0, 10}, 0, 0, true);
    const auto goodbye = mute->next<wire::Goodbye>(3s);
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->parsed->as<wire::Goodbye>()->reason()->str(),
              "no Pose came within 0.4 s of Hello: send one, hidden where nothing is to be drawn");
    EXPECT_EQ(mute->closeCode(), 1008);
    EXPECT_TRUE(eventually([&] { return audience->size() == 1; }));
    hidden->pose(2);
    EXPECT_TRUE(frameOf(*hidden, 2));
}

// What no message is made of: the flood ends with one line, and nobody else feels it.
void floodEnds(WsClient& good, WsClient& bad, const std::string& frame) {
    std::string flood;
    for (int i = 0; i < 1000; ++i) flood += frame;
    const std::jthread sender([&] {
        for (int i = 0; i < 200 && bad.socket.send(flood); ++i) {
        }
    });
    const auto goodbye = bad.next<wire::Goodbye>(10s);
    ASSERT_TRUE(goodbye && goodbye->parsed) << "200,000 frames went through";
    EXPECT_EQ(goodbye->parsed->as<wire::Goodbye>()->reason()->str(), "too many WebSocket pings or fragments");
    good.pose(1);
    EXPECT_TRUE(frameOf(good, 1));
}

const std::string kMask = "abcd"; // of frames without content: any

TEST_F(SessionTest, AFloodOfPingsIsClosed) {
    options.message_rate = 500;
    serve();
    const auto good = watch(), bad = watch();
    floodEnds(*good, *bad, "\x89\x80" + kMask);
}

TEST_F(SessionTest, AFloodOfPongsIsClosed) {
    options.message_rate = 500;
    serve();
    const auto good = watch(), bad = watch();
    floodEnds(*good, *bad, "\x8a\x80" + kMask);
}

TEST_F(SessionTest, AFloodOfEmptyFragmentsIsClosed) {
    options.message_rate = 500;
    serve();
    const auto good = watch(), bad = watch();
    bad->socket.send(std::string("\x02\x80", 2) + kMask);
    floodEnds(*good, *bad, std::string("\x00\x80", 2) + kMask);
}

TEST_F(SessionTest, FragmentsAndPingsAtAHumanRateAreServed) {
    serve();
    const auto client = watch();
    const wire::Packed ping = wire::pack([](auto& b) { return wire::CreatePing(b, 7, 1); });
    const auto bytes = wire::bytesOf(ping);
    for (int round = 0; round < 300; ++round) {
        std::string frames;
        for (size_t i = 0; i < bytes.size(); ++i) { // a byte each, a ping in their midst
            frames += char((i == 0 ? 2 : 0) | (i + 1 == bytes.size() ? 0x80 : 0));
            frames += std::string("\x81\0\0\0\0", 5) + char(bytes[i]);
            if (i == 3) frames += "\x89\x80" + kMask;
        }
        ASSERT_TRUE(client->socket.send(frames)) << round;
        ASSERT_TRUE(client->next<wire::Pong>()) << round;
    }
}

TEST_F(SessionTest, VanishingViewersFreeTheirPlaces) {
    max_viewers = 2;
    serve();
    for (int round = 0; round < 5; ++round) {
        const auto first = watch(), second = watch();
        first->pose(1);
        ASSERT_TRUE(frameOf(*first, 1));
        first->socket.reset();
        second->socket.reset();
        ASSERT_TRUE(eventually([&] { return audience->size() == 0; })) << round;
    }
}

// A tab that is closed, and a machine that goes away: no reason to wake an operator.
TEST_F(SessionTest, AViewerThatLeavesIsNothingToWarnOf) {
    const LogCapture log;
    serve();
    renderer->jpeg_bytes = 2 << 20; // more than a socket takes, so that writes wait when the viewer goes
    const auto gone = [&] { return eventually([&] { return audience->size() == 0; }); };
    const auto looking = [&](int receive_buffer) {
        auto client = watch(64, 48, 1, receive_buffer);
        client->pose(1);
        EXPECT_FALSE(client->socket.read(1, 5s).empty()) << "a frame comes";
        return client;
    };
    looking(0)->sendMessage(8, std::vector<uint8_t>{0x03, 0xe9}); // 1001, what a browser says when its page is left
    EXPECT_TRUE(gone());
    looking(4096); // closed with unread data
    EXPECT_TRUE(gone());
    looking(4096)->socket.reset();
    EXPECT_TRUE(gone());
    {
        Socket stream(server->port(), 4096);
        stream.send("GET /stream.mjpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
        EXPECT_NE(stream.readUntil("\r\n").find(" 200 "), std::string::npos);
        stream.reset();
    }
    EXPECT_TRUE(gone());
    const WsClient silent(server->port()); // upgraded, and gone before it says hello
    EXPECT_EQ(silent.handshake.status, 101);
    server.reset();
    EXPECT_EQ(log.atLeast(spdlog::level::warn), "");
}

TEST_F(SessionTest, AnIdleViewerIsPingedAndASilentOneCut) {
    options.idle = 400ms;
    serve();
    const auto awake = watch(), asleep = watch();
    asleep->answer_pings = false;
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < 1500ms) awake->receive(50ms);
    EXPECT_EQ(audience->size(), 1u);
    EXPECT_TRUE(asleep->socket.closesWithin(2s));
    awake->pose(1);
    EXPECT_TRUE(frameOf(*awake, 1));
}

} // namespace
} // namespace brume::test

// A viewer's life over a real socket.
#include "tests/net/session_fixture.h"
#include "tests/net/set_message.h"

namespace brume::test {
namespace {

using wire::ErrorCode;

TEST_F(SessionTest, WelcomeSaysWhatThereIsAndTheStateFollows) {
    const uint16_t port = serve();
    WsClient client(port);
    ASSERT_EQ(client.handshake.status, 101);
    EXPECT_EQ(client.handshake.header("Sec-WebSocket-Protocol"), "brume.v1");
    EXPECT_EQ(client.handshake.header("Sec-WebSocket-Extensions"), "") << "no compression";
    client.hello(1280, 720, 2);
    const auto first = client.receive();
    ASSERT_TRUE(first && first->parsed);
    const auto* welcome = first->parsed->as<wire::Welcome>();
    ASSERT_TRUE(welcome);
    EXPECT_GT(welcome->viewer(), 0u);
    EXPECT_EQ(welcome->scene()->str(), "test scene");
    EXPECT_EQ(welcome->device()->str(), "test device");
    EXPECT_EQ(welcome->server()->str(), "brume " BRUME_VERSION);
    EXPECT_EQ(welcome->width(), 1280);
    EXPECT_EQ(welcome->height(), 720);
    EXPECT_EQ(welcome->views(), 2);
    EXPECT_EQ(welcome->tick_hz(), 60);
    EXPECT_EQ(welcome->max_in_flight(), 2);
    EXPECT_EQ(welcome->camera()->position()->z(), 26);
    ASSERT_EQ(welcome->methods()->size(), 2u);
    EXPECT_EQ(welcome->methods()->Get(1)->str(), "isv");
    EXPECT_EQ(welcome->quadratures()->Get(0)->str(), "simpson");

    auto second = client.receive();
    while (second && second->parsed && second->parsed->as<wire::Ping>()) second = client.receive();
    ASSERT_TRUE(second && second->parsed);
    const auto* state = second->parsed->as<wire::SceneState>();
    ASSERT_TRUE(state) << "before any frame";
    EXPECT_EQ(state->viewers(), 1u);
    EXPECT_GT(state->tick(), 0u);
}

TEST_F(SessionTest, UpgradesThatCannotBeAreToldWhy) {
    const uint16_t port = serve();
    const auto plain = get(port, "/ws");
    EXPECT_EQ(plain.status, 426);
    EXPECT_EQ(plain.header("Upgrade"), "websocket");
    EXPECT_NE(plain.body.find("brume.v1"), std::string::npos);

    // What a proxy leaves of a handshake when it passes on no headers of one connection.
    Socket lost(port);
    lost.send("GET /ws HTTP/1.0\r\nHost: 127.0.0.1\r\nConnection: close\r\nSec-WebSocket-Version: 13\r\n"
              "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: brume.v1\r\n\r\n");
    const HttpAnswer told = readAnswer(lost);
    EXPECT_EQ(told.status, 426);
    EXPECT_EQ(told.body, "the proxy in front of this server does not pass WebSockets on: see docs/deploy.md\n");

    const WsClient none(port, 0, ""), other(port, 0, "Sec-WebSocket-Protocol: brume.v2, chat\r\n");
    EXPECT_EQ(none.handshake.status, 400);
    EXPECT_EQ(other.handshake.status, 400);
    EXPECT_NE(other.handshake.body.find("brume.v1"), std::string::npos);
    const WsClient several(port, 0, "Sec-WebSocket-Protocol: brume.v2, brume.v1\r\n");
    EXPECT_EQ(several.handshake.status, 101);
    EXPECT_EQ(several.handshake.header("Sec-WebSocket-Protocol"), "brume.v1");
}

TEST_F(SessionTest, OnlyOurOwnPageMayConnectUnlessAllowed) {
    options.allowed_origins = {"https://clouds.example"};
    const uint16_t port = serve();
    const auto status = [&](const std::string& origin) {
        return WsClient(port, 0, "Sec-WebSocket-Protocol: brume.v1\r\nOrigin: " + origin + "\r\n").handshake.status;
    };
    EXPECT_EQ(status(fmt::format("http://127.0.0.1:{}", port)), 101);
    EXPECT_EQ(status("https://clouds.example"), 101);
    EXPECT_EQ(status("http://clouds.example"), 403);
    EXPECT_EQ(status("https://evil.example"), 403);
    EXPECT_EQ(status("null"), 403);
    EXPECT_EQ(status(fmt::format("http://127.0.0.1:{}.evil.example", port)), 403);
}

TEST_F(SessionTest, ThreeViewersGetTheirOwnPictures) {
    options.threads = 3;
    serve();
    std::vector<std::unique_ptr<WsClient>> clients;
    for (int i = 0; i < 3; ++i) {
        clients.push_back(watch(uint16_t(100 + 10 * i), 80));
        clients.back()->pose(7, {float(i), 0.5f, 3});
    }
    for (int i = 0; i < 3; ++i) {
        uint32_t last_id = 0;
        for (int n = 0; n < 5; ++n) {
            const auto message = clients[size_t(i)]->next<wire::Frame>();
            ASSERT_TRUE(message);
            const auto* frame = message->parsed->as<wire::Frame>();
            EXPECT_GT(frame->id(), last_id);
            last_id = frame->id();
            EXPECT_EQ(frame->pose_seq(), 7u);
            EXPECT_EQ(frame->client_time_us(), 1007u);
            EXPECT_EQ(frame->position()->x(), float(i));
            EXPECT_EQ(frame->width(), 100 + 10 * i);
            EXPECT_EQ(frame->quality(), options.default_quality);
            EXPECT_EQ(frame->state_hash(), frame->tick() * 0x9e3779b97f4a7c15);
            EXPECT_EQ(frame->stages()->wait(), 1);
            EXPECT_EQ(frame->stages()->render(), 2);
            EXPECT_EQ(frame->stages()->encode(), 3);
            EXPECT_EQ(frame->stages()->gpu(), 1.5f);
            EXPECT_GE(frame->stages()->queue(), 0);
            EXPECT_LT(frame->stages()->queue(), 1000);
            EXPECT_EQ(pictureText(message->parsed->view(0)),
                      fmt::format("seq 7 eye 0 at {} 0.5 3 size {}x80 quality 80", i, 100 + 10 * i));
            clients[size_t(i)]->ack(frame->id());
        }
    }
}

TEST_F(SessionTest, BothEyesComeInOneMessage) {
    serve();
    const auto client = watch(64, 48, 2);
    client->pose(1);
    const auto message = client->next<wire::Frame>();
    ASSERT_TRUE(message);
    ASSERT_EQ(message->parsed->as<wire::Frame>()->jpeg_bytes()->size(), 2u);
    EXPECT_NE(pictureText(message->parsed->view(0)).find("eye 0"), std::string::npos);
    EXPECT_NE(pictureText(message->parsed->view(1)).find("eye 1"), std::string::npos);
}

TEST_F(SessionTest, ANewPoseAndItsSizeShow) {
    serve();
    const auto client = watch();
    client->pose(1);
    ASSERT_TRUE(frameOf(*client, 1));
    client->pose(2, {1, 2, 3}, 320, 200);
    const auto message = frameOf(*client, 2);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->parsed->as<wire::Frame>()->width(), 320);
    client->pose(1, {9, 9, 9}); // late: not shown any more
    client->pose(3);
    ASSERT_TRUE(frameOf(*client, 3));
}

TEST_F(SessionTest, WhoNeverAcknowledgesIsNotRenderedFor) {
    serve();
    const auto client = watch();
    client->pose(1);
    ASSERT_TRUE(client->next<wire::Frame>());
    const auto second = client->next<wire::Frame>();
    ASSERT_TRUE(second);
    // Frames are numbered as they are made. On a slow machine one may replace another that has not gone out.
    const uint32_t last = second->parsed->as<wire::Frame>()->id();
    const uint64_t rounds = renderer->rounds;
    ASSERT_TRUE(eventually([&] { return renderer->rounds > rounds + 50; }));
    EXPECT_EQ(renderer->made, last);
    client->ack(last);
    const auto message = client->next<wire::Frame>();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->parsed->as<wire::Frame>()->id(), last + 1);
    client->ack(77);
    EXPECT_EQ(nextError(*client), ErrorCode::unexpected);
}

TEST_F(SessionTest, AFullHouseSaysSoAndTakesTheNextWhenOneLeaves) {
    max_viewers = 2;
    const uint16_t port = serve();
    auto first = watch();
    const auto second = watch();
    WsClient third(port);
    third.hello();
    EXPECT_EQ(nextError(third), ErrorCode::full);
    const auto goodbye = third.next<wire::Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_GT(goodbye->parsed->as<wire::Goodbye>()->retry_after_s(), 0);
    EXPECT_EQ(third.closeCode(), 1013);

    first->say([](auto& b) { return wire::CreateGoodbye(b); });
    EXPECT_EQ(first->closeCode(), 1000);
    ASSERT_TRUE(eventually([&] { return audience->size() == 1; }));
    EXPECT_TRUE(watch());
}

TEST_F(SessionTest, PingsAreAnsweredWithTheirOwnTime) {
    serve();
    const auto client = watch();
    client->say([](auto& b) { return wire::CreatePing(b, 42, 123456789); });
    const auto message = client->next<wire::Pong>();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->parsed->as<wire::Pong>()->nonce(), 42u);
    EXPECT_EQ(message->parsed->as<wire::Pong>()->time_us(), 123456789u);
}

TEST_F(SessionTest, ABurstOfPingsIsAnsweredInFull) {
    serve();
    const auto client = watch();
    const uint32_t pings = 3000;
    std::thread sender([&] {
        for (uint32_t nonce = 1; nonce <= pings; ++nonce)
            if (!client->say([&](auto& b) { return wire::CreatePing(b, nonce, 0); })) return;
    });
    for (uint32_t nonce = 1; nonce <= pings; ++nonce) {
        const auto message = client->next<wire::Pong>();
        if (!message || message->parsed->as<wire::Pong>()->nonce() != nonce) {
            ADD_FAILURE() << "no pong " << nonce;
            break;
        }
    }
    sender.join();
}

TEST_F(SessionTest, CommandsReachTheSceneInOrderAndEveryoneSeesThem) {
    serve();
    const auto one = watch(), other = watch();
    const auto input = [](WsClient& client, uint32_t seq, bool paused) {
        client.say([&](auto& b) {
            return wire::CreateInput(b, seq, 0, wire::Command::Set, test::set("simulation.paused", paused)(b).Union());
        });
    };
    for (uint32_t seq = 1; seq <= 99; ++seq) input(*one, seq, seq % 2 != 0);
    ASSERT_TRUE(eventually([&] { return renderer->commands().size() == 99; }));
    const auto commands = renderer->commands();
    for (uint32_t i = 0; i < 99; ++i) EXPECT_EQ(commands[i].seq, i + 1);
    EXPECT_EQ(commands[0].viewer, commands[98].viewer);

    const auto start = std::chrono::steady_clock::now();
    bool paused = false;
    while (!paused && std::chrono::steady_clock::now() - start < 900ms) {
        const auto message = other->next<wire::SceneState>();
        ASSERT_TRUE(message);
        paused = message->parsed->as<wire::SceneState>()->paused();
    }
    EXPECT_TRUE(paused) << "told at once, not with the report of the second";
}

TEST_F(SessionTest, WrongNamesAndAFullQueueAreAnsweredByNumber) {
    options.input_rate = options.message_rate = 1e6;
    serve();
    const auto client = watch();
    client->say([](auto& b) {
        return wire::CreateInput(b, 1, 0, wire::Command::Set, test::set("render.method", "tetra")(b).Union());
    });
    const auto unknown = client->next<wire::Error>();
    ASSERT_TRUE(unknown);
    EXPECT_EQ(unknown->parsed->as<wire::Error>()->code(), ErrorCode::unknown_name);
    EXPECT_EQ(unknown->parsed->as<wire::Error>()->input_seq(), 1u);

    pauseRenderer();
    uint32_t seq = 1;
    for (int i = 0; i < 4097; ++i)
        client->say([&](auto& b) {
            return wire::CreateInput(b, ++seq, 0, wire::Command::Restart, wire::CreateRestart(b).Union());
        });
    const auto busy = client->next<wire::Error>();
    ASSERT_TRUE(busy);
    EXPECT_EQ(busy->parsed->as<wire::Error>()->code(), ErrorCode::busy);
    EXPECT_EQ(busy->parsed->as<wire::Error>()->input_seq(), seq);
    renderer->paused = false;
    EXPECT_TRUE(eventually([&] { return renderer->commands().size() == 4096; })) << "what was taken is not lost";
}

// The simulation takes so many in a tick: who pushes more is told, and may push again after it.
TEST_F(SessionTest, ImpulsesBeyondWhatATickTakesAreAnsweredByNumber) {
    serve();
    const auto client = watch();
    uint32_t input_seq = 0;
    const auto pushTo = [&](uint32_t last) {
        static const wire::Vec3 ahead(0, 0, -1);
        for (; input_seq < last; ++input_seq)
            client->say([&](auto& b) {
                return wire::CreateInput(b, input_seq + 1, 0, wire::Command::Impulse,
                                         wire::CreateImpulse(b, &ahead, &ahead).Union());
            });
    };
    pauseRenderer();
    pushTo(kMostImpulses + 1);
    const auto busy = client->next<wire::Error>();
    ASSERT_TRUE(busy);
    EXPECT_EQ(busy->parsed->as<wire::Error>()->code(), ErrorCode::busy);
    EXPECT_EQ(busy->parsed->as<wire::Error>()->input_seq(), kMostImpulses + 1);
    renderer->paused = false;
    ASSERT_TRUE(eventually([&] { return renderer->commands().size() == kMostImpulses; }));
    pushTo(kMostImpulses + 2);
    EXPECT_TRUE(eventually([&] { return renderer->commands().size() == kMostImpulses + 1; }));
}

TEST_F(SessionTest, TheStateComesOnceASecondAndWhenSomeoneComes) {
    serve();
    const auto client = watch();
    // The server's pings say when it sent them: the last before a state and the first after the next one enclose both.
    uint64_t before = 0, after = 0; // us, of the server's clock
    std::unique_ptr<Received> next;
    for (int states = 0; states < 2 || after == 0;) {
        auto message = client->receive();
        ASSERT_TRUE(message && message->parsed);
        if (const auto* ping = message->parsed->as<wire::Ping>()) {
            (states == 0 ? before : after) = ping->time_us();
            if (states == 1) after = 0;
            client->say([&](auto& b) { return wire::CreatePong(b, ping->nonce(), ping->time_us()); });
        }
        if (message->parsed->as<wire::SceneState>() && before > 0 && ++states == 2) next = std::move(message);
    }
    EXPECT_GE(after - before, 1'000'000u);
    EXPECT_EQ(next->parsed->as<wire::SceneState>()->passes()->size(), 2u);
    EXPECT_EQ(next->parsed->as<wire::SceneState>()->particles(), 500u);

    const auto start = std::chrono::steady_clock::now();
    std::vector<std::unique_ptr<WsClient>> others;
    for (uint32_t viewers = 2; viewers <= 6; ++viewers) {
        others.push_back(watch());
        for (uint32_t told = 0; told != viewers;) {
            const auto news = client->next<wire::SceneState>();
            ASSERT_TRUE(news);
            told = news->parsed->as<wire::SceneState>()->viewers();
        }
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, 4s) << "once a second alone would take longer";
}

} // namespace
} // namespace brume::test

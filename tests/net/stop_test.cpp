// Starting where it cannot be, and stopping while others look on.
#include "tests/net/fixture.h"
#include "tests/net/log_capture.h"

namespace brume::test {
namespace {

struct StopTest : ServerTest {};

std::string startError(net::NetOptions options, Audience& audience, Metrics& metrics) {
    try {
        NetServer(std::move(options), audience, metrics).start();
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "started";
}

TEST_F(StopTest, ATakenPortIsToldInOneLine) {
    options.port = serve();
    EXPECT_EQ(
        startError(options, *audience, *metrics),
        fmt::format("cannot listen on 127.0.0.1:{}: Address already in use; choose another with --port", options.port));
    EXPECT_THROW(checkNetwork(options), std::runtime_error);
    options.port = 0;
    EXPECT_NO_THROW(checkNetwork(options));
    options.port = server->port();
    options.listen = "192.0.2.1"; // an address of nobody's
    EXPECT_EQ(
        startError(options, *audience, *metrics),
        fmt::format("cannot listen on 192.0.2.1:{}: Cannot assign requested address; choose another with --listen",
                    options.port));
    options.listen = "not an address";
    const std::string unknown = startError(options, *audience, *metrics);
    EXPECT_NE(unknown.find("choose another with --listen"), std::string::npos) << unknown;
}

TEST_F(StopTest, ACertificateThatIsNoneIsToldBeforeAnythingElseIsDone) {
    options.tls_certificate = options.tls_key = "/nosuch.pem";
    EXPECT_THROW(checkNetwork(options), std::runtime_error);
}

TEST_F(StopTest, EveryoneIsToldGoodbye) {
    const uint16_t port = serve();
    const auto one = watch(), two = watch();
    one->pose(1);
    Socket stream(port), kept(port), snapshot(port);
    stream.send("GET /stream.mjpg?fps=5 HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_NE(stream.readUntil("--brume-frame").find("200 OK"), std::string::npos);
    kept.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_EQ(readAnswer(kept).status, 200);

    std::chrono::steady_clock::duration took{};
    std::thread stopper([&] {
        const auto start = std::chrono::steady_clock::now();
        server->stop(5s);
        took = std::chrono::steady_clock::now() - start;
    });
    for (WsClient* client : {one.get(), two.get()}) {
        const auto goodbye = client->next<wire::Goodbye>();
        EXPECT_TRUE(goodbye);
        if (goodbye) {
            EXPECT_GT(goodbye->parsed->as<wire::Goodbye>()->retry_after_s(), 0);
        }
        EXPECT_EQ(client->closeCode(), 1001);
        EXPECT_TRUE(client->socket.closesWithin(3s));
    }
    EXPECT_TRUE(stream.closesWithin(3s));
    EXPECT_TRUE(kept.closesWithin(3s));
    stopper.join();
    EXPECT_LT(took, 3s);
    EXPECT_EQ(audience->size(), 0u);
    EXPECT_THROW(Socket again(port), std::runtime_error) << "the port is free";
}

TEST_F(StopTest, ADrainFailsReadyzAndNothingElseAndTheGoodbyeSaysWhereToGo) {
    const uint16_t port = serve();
    const auto viewer = watch();
    viewer->pose(1);
    ASSERT_TRUE(viewer->next<wire::Frame>());
    EXPECT_EQ(get(port, "/readyz").status, 200);
    server->drain();
    const auto answer = get(port, "/readyz");
    EXPECT_EQ(answer.status, 503);
    EXPECT_NE(answer.body.find("drains"), std::string::npos) << answer.body;
    EXPECT_EQ(get(port, "/healthz").status, 200);
    viewer->ack(1);
    viewer->pose(2);
    EXPECT_TRUE(viewer->next<wire::Frame>());
    EXPECT_TRUE(watch()) << "who comes is served";

    std::thread stopper([&] { server->stop(5s, "wss://next.example"); });
    const auto goodbye = viewer->next<wire::Goodbye>();
    EXPECT_TRUE(goodbye);
    if (goodbye) {
        const auto* message = goodbye->parsed->as<wire::Goodbye>();
        EXPECT_TRUE(message->go_to() && message->go_to()->str() == "wss://next.example");
    }
    EXPECT_EQ(viewer->closeCode(), 1001);
    stopper.join();
}

TEST_F(StopTest, NewOptionsHoldForNewConnections) {
    const uint16_t port = serve();
    const auto ask = [](Socket& socket) {
        socket.send("GET /snapshot.jpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
        return readAnswer(socket).status;
    };
    Socket old(port);
    EXPECT_EQ(ask(old), 200);
    net::NetOptions changed = options;
    changed.max_snapshots = 0;
    changed.port = 1; // which stays as it is
    server->setOptions(changed);
    EXPECT_EQ(server->port(), port);
    EXPECT_EQ(ask(old), 200);
    Socket young(port);
    EXPECT_EQ(ask(young), 503);
    changed.max_connections = 2;
    server->setOptions(changed);
    Socket refused(port);
    EXPECT_EQ(ask(refused), 503);
    EXPECT_EQ(ask(old), 200) << "who is in stays in";
}

TEST_F(StopTest, WhoDoesNotListenIsCutAtTheDeadline) {
    const LogCapture log;
    const uint16_t port = serve();
    renderer->jpeg_bytes = 2 << 20;
    const auto stalled = watch(640, 360, 1, 4096);
    stalled->pose(1);
    const auto mute = watch(); // never answers the close
    Socket stream(port, 4096);
    stream.send("GET /stream.mjpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_TRUE(eventually([&] { return audience->size() == 3 && renderer->made >= 2; }));
    const auto start = std::chrono::steady_clock::now();
    server->stop(400ms);
    const auto took = std::chrono::steady_clock::now() - start;
    EXPECT_GE(took, 400ms) << "the grace";
    EXPECT_EQ(log.atLeast(spdlog::level::warn), "") << "every connection ended when it was cut";
    EXPECT_EQ(audience->size(), 0u);
    server.reset(); // before the log is put back
}

// A context for every set of options would be memory that every reload adds, more of it with a certificate.
TEST_F(StopTest, OldOptionsAreDroppedWithTheirLastConnection) {
    const uint16_t port = serve();
    EXPECT_EQ(server->contexts(), 1u);
    {
        Socket open(port);
        open.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
        ASSERT_EQ(readAnswer(open).status, 200);
        for (int i = 0; i < 10; ++i) server->setOptions(options);
        EXPECT_EQ(server->contexts(), 2u) << "the newest, and that of the open connection";
    }
    EXPECT_TRUE(eventually([&] { return server->contexts() == 1; }));
    const auto viewer = watch();
    server->setOptions(options);
    EXPECT_EQ(server->contexts(), 2u) << "a WebSocket keeps its options too";
    viewer->socket.reset();
    EXPECT_TRUE(eventually([&] { return server->contexts() == 1; }));
}

TEST_F(StopTest, ManyComeAndGoWhileItStops) {
    options.threads = 3;
    const uint16_t port = serve();
    std::atomic<bool> done{false};
    std::vector<std::thread> crowd;
    for (int i = 0; i < 4; ++i)
        crowd.emplace_back([&] {
            while (!done) {
                try {
                    WsClient client(port);
                    client.hello();
                    client.pose(1);
                    client.next<wire::Frame>(200ms);
                } catch (const std::runtime_error&) {
                    return; // stopped
                }
            }
        });
    for (int i = 0; i < 30; ++i) { // and while its options change
        std::this_thread::sleep_for(10ms);
        net::NetOptions changed = options;
        changed.max_connections = 100 + uint32_t(i);
        changed.pose_rate = 100 + i;
        changed.allowed_origins = {"https://" + std::to_string(i) + ".example"};
        server->setOptions(changed);
    }
    server->stop(1s, "https://next.example");
    EXPECT_THROW(Socket late(port), std::runtime_error) << "nobody waits for a server that has stopped";
    done = true;
    EXPECT_EQ(audience->size(), 0u);
    server.reset(); // closes what was accepted last, when nobody served it any more
    for (auto& visitor : crowd) visitor.join();
}

} // namespace
} // namespace brume::test

// What HTTP connections may take: sockets, time, streams and snapshots.
#include "tests/net/fixture.h"

namespace brume::test {
namespace {

struct HttpLimitsTest : ServerTest {};

TEST_F(HttpLimitsTest, OneAddressMayNotTakeAllConnections) {
    options.max_connections_per_address = 3;
    const uint16_t port = serve();
    std::vector<std::unique_ptr<Socket>> open;
    for (int i = 0; i < 3; ++i) {
        open.push_back(std::make_unique<Socket>(port));
        open.back()->send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
        EXPECT_EQ(readAnswer(*open.back()).status, 200);
    }
    EXPECT_EQ(get(port, "/metrics").status, 503);
    open.pop_back();
    EXPECT_TRUE(eventually([&] { return get(port, "/metrics").status == 200; }));
}

// Sockets that say nothing hold every place: a health check still gets through, and nothing else does.
TEST_F(HttpLimitsTest, AHealthCheckGetsThroughWhenAllConnectionsAreTaken) {
    options.max_connections = 3;
    const uint16_t port = serve();
    std::vector<std::unique_ptr<Socket>> open;
    for (int i = 0; i < 3; ++i) open.push_back(std::make_unique<Socket>(port));
    for (const char* path : {"/healthz", "/readyz"}) {
        Socket check(port);
        check.send(fmt::format("GET {} HTTP/1.1\r\nHost: localhost\r\n\r\n", path));
        EXPECT_EQ(readAnswer(check).status, 200) << path;
        EXPECT_TRUE(check.closesWithin(3s)) << "one request";
    }
    for (const char* path : {"/", "/metrics", "/snapshot.jpg", "/ws"}) {
        const HttpAnswer answer = get(port, path);
        EXPECT_EQ(answer.status, 503) << path;
        EXPECT_EQ(answer.body, "too many connections: try again later\n");
        EXPECT_EQ(answer.header("Retry-After"), "5");
    }
    Socket silent(port);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_TRUE(silent.closesWithin(3s)) << "its header must come within a second";
    EXPECT_GE(std::chrono::steady_clock::now() - start, 900ms);
    EXPECT_FALSE(open.front()->closesWithin(0ms)) << "the others have longer";
}

TEST_F(HttpLimitsTest, AHeaderThatHasBegunEndsInTimeOnAKeptConnectionToo) {
    options.handshake = 300ms;
    options.keep_alive = 60s;
    Socket socket(serve());
    socket.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(readAnswer(socket).status, 200);
    EXPECT_FALSE(socket.closesWithin(600ms)) << "nothing has begun";
    socket.send("GET /healthz HT");
    EXPECT_TRUE(socket.closesWithin(3s));
}

TEST_F(HttpLimitsTest, AConnectionThatAsksNoMoreIsClosed) {
    options.keep_alive = 300ms;
    const uint16_t port = serve();
    Socket socket(port);
    socket.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(readAnswer(socket).status, 200);
    const auto viewer = watch();
    EXPECT_TRUE(socket.closesWithin(3s));
    viewer->pose(1);
    EXPECT_TRUE(viewer->next<wire::Frame>()) << "a WebSocket has its own time";
}

TEST_F(HttpLimitsTest, StreamsHaveTheirOwnLimit) {
    options.max_streams = 1;
    const uint16_t port = serve();
    Socket one(port);
    one.send("GET /stream.mjpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_NE(one.readUntil("--brume-frame").find("200 OK"), std::string::npos) << "one place is for anybody";
    const HttpAnswer full = get(port, "/stream.mjpg");
    EXPECT_EQ(full.status, 503);
    EXPECT_EQ(full.body, "1 streams are open, the most at a time\n");
    EXPECT_TRUE(watch()) << "viewers still find room";
}

TEST_F(HttpLimitsTest, OneAddressHasThreeQuartersOfTheStreams) {
    options.max_streams = 4;
    const uint16_t port = serve();
    std::vector<std::unique_ptr<Socket>> open;
    for (int i = 0; i < 3; ++i) {
        open.push_back(std::make_unique<Socket>(port));
        open.back()->send("GET /stream.mjpg?w=64&h=36&fps=20 HTTP/1.1\r\nHost: localhost\r\n\r\n");
        EXPECT_NE(open.back()->readUntil("--brume-frame").find("200 OK"), std::string::npos);
    }
    const HttpAnswer over = get(port, "/stream.mjpg");
    EXPECT_EQ(over.status, 503);
    EXPECT_EQ(over.body, "3 streams are open for your address or token name, the most of 4\n");
    open.pop_back();
    EXPECT_TRUE(eventually([&] {
        Socket again(port);
        again.send("GET /stream.mjpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
        return again.readUntil("\r\n").find(" 200 ") != std::string::npos;
    }));
}

TEST_F(HttpLimitsTest, OneAddressHasThreeQuartersOfTheSnapshots) {
    options.max_snapshots = 2;
    options.frame_wait = 10s;
    const uint16_t port = serve();
    pauseRenderer();
    Socket first(port);
    first.send("GET /snapshot.jpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_TRUE(eventually([&] { return audience->size() == 1; }));
    EXPECT_EQ(get(port, "/snapshot.jpg").body,
              "1 snapshots are being drawn for your address or token name, the most of 2\n");
    renderer->paused = false;
    EXPECT_EQ(readAnswer(first).status, 200);
}

// Where a stream or a snapshot waits, its client closes or resets the connection; some have sent more before.
const std::vector<std::pair<std::string, bool>> kEnds = {
    {"", false}, {"", true}, {"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n", false}};

TEST_F(HttpLimitsTest, ASnapshotWhoseClientHasGoneIsNotDrawn) {
    options.frame_wait = 60s;
    options.max_snapshots = 1;
    const uint16_t port = serve();
    pauseRenderer();
    for (const auto& [more, reset] : kEnds) {
        SCOPED_TRACE(more + (reset ? " reset" : " closed"));
        {
            Socket one(port);
            one.send("GET /snapshot.jpg HTTP/1.1\r\nHost: localhost\r\n\r\n" + more);
            ASSERT_TRUE(eventually([&] { return audience->size() == 1; }));
            if (reset) one.reset();
        }
        EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
    }
    EXPECT_EQ(renderer->made, 0u);
    renderer->paused = false;
    EXPECT_EQ(get(port, "/snapshot.jpg").status, 200) << "the place is free";
    EXPECT_EQ(renderer->made, 1u);
}

TEST_F(HttpLimitsTest, ASlowStreamWhoseClientHasGoneGivesItsPlaceBackAtOnce) {
    options.max_streams = 1;
    const uint16_t port = serve();
    for (const auto& [more, reset] : kEnds) {
        SCOPED_TRACE(more + (reset ? " reset" : " closed"));
        {
            Socket one(port);
            one.send("GET /stream.mjpg?fps=0.1 HTTP/1.1\r\nHost: localhost\r\n\r\n" + more);
            const std::string first = one.readUntil("--brume-frame") + one.readUntil("--brume-frame");
            ASSERT_NE(first.find(" 200 "), std::string::npos) << first;
            if (reset) one.reset();
        }
        EXPECT_TRUE(eventually([&] { return audience->size() == 0; })) << "its next frame is due in ten seconds";
    }
}

// What a client sends while it waits for a picture is its next request.
TEST_F(HttpLimitsTest, WhatComesBehindASnapshotIsAnsweredAfterIt) {
    options.frame_wait = 10s;
    const uint16_t port = serve();
    pauseRenderer();
    Socket one(port);
    one.send("GET /snapshot.jpg HTTP/1.1\r\nHost: localhost\r\n\r\nGET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_TRUE(eventually([&] { return audience->size() == 1; }));
    one.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    renderer->paused = false;
    for (int i = 0; i < 3; ++i) EXPECT_EQ(readAnswer(one).status, 200) << i;
}

} // namespace
} // namespace brume::test

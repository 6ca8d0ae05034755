// ServerTest: the real network server on a free port, with FakeRenderer as its frame loop.
#pragma once

#include <functional>
#include <optional>

#include <gtest/gtest.h>

#include "server/net/server.h"
#include "tests/net/fake_renderer.h"
#include "tests/net/test_client.h"

namespace brume::test {

// Waits until another thread has made the condition true; false if it does not within the time.
inline bool eventually(const std::function<bool()>& condition, Milliseconds timeout = 5s) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (!condition()) {
        if (std::chrono::steady_clock::now() >= deadline) return false;
        std::this_thread::sleep_for(2ms);
    }
    return true;
}

class ServerTest : public testing::Test {
protected:
    net::NetOptions options;
    uint32_t max_viewers = 8, max_in_flight = 2;
    std::optional<Audience> audience;
    std::optional<Metrics> metrics;
    std::optional<FakeRenderer> renderer;
    std::optional<NetServer> server;

    ServerTest() { options.port = 0; }

    // Starts the server; returns its port. To be called after the options are set.
    uint16_t serve() {
        Scene scene;
        scene.name = "test scene";
        scene.camera = {{0, 2, 26}, {0, 0, 0}, 0.75f};
        const ServerFacts facts{"test device", {"sphere", "isv"}};
        audience.emplace(facts, sceneFacts(scene), max_viewers, max_in_flight);
        metrics.emplace();
        renderer.emplace(*audience, *metrics);
        server.emplace(options, *audience, *metrics);
        server->start();
        EXPECT_TRUE(eventually([&] { return audience->report()->tick > 0; }));
        return server->port();
    }
    void TearDown() override {
        server.reset();
        renderer.reset();
    }

    // Stops rendering and taking commands, and waits until the running round has ended.
    void pauseRenderer() {
        renderer->paused = true;
        const uint64_t rounds = renderer->rounds;
        ASSERT_TRUE(eventually([&] { return renderer->rounds >= rounds + 2; }));
    }

    // Connects a viewer and waits for its welcome.
    std::unique_ptr<WsClient> watch(uint16_t width = 640, uint16_t height = 360, uint8_t views = 1,
                                    int receive_buffer = 0) {
        auto client = std::make_unique<WsClient>(server->port(), receive_buffer);
        EXPECT_EQ(client->handshake.status, 101);
        client->hello(width, height, views);
        EXPECT_TRUE(client->next<wire::Welcome>());
        return client;
    }
};

inline std::string pictureText(std::span<const uint8_t> jpeg) {
    return jpeg.size() < 4 ? "" : std::string(jpeg.begin() + 2, jpeg.end() - 2);
}

} // namespace brume::test

// Where viewers are sent whom a server does not keep.
#include "tests/net/session_fixture.h"

namespace brume::test {
namespace {

struct ElsewhereTest : ServerTest {
    std::string next = "https://b.example/"; // outlives the server

    struct Farewell {
        std::string go_to;
        float retry_after_s = -1;
    };
    static Farewell farewell(WsClient& client) {
        const auto message = client.next<wire::Goodbye>();
        EXPECT_TRUE(message);
        if (!message) return {};
        const auto* goodbye = message->parsed->as<wire::Goodbye>();
        return {goodbye->go_to() ? goodbye->go_to()->str() : "", goodbye->retry_after_s()};
    }
    // Of a viewer that finds no place.
    Farewell turnedAway() {
        WsClient late(server->port());
        late.hello();
        EXPECT_EQ(nextError(late), wire::ErrorCode::full);
        Farewell told = farewell(late);
        EXPECT_EQ(late.closeCode(), 1013);
        return told;
    }
    // Of a viewer that is there when the server stops.
    Farewell stopped(const std::string& go_to) {
        const auto viewer = watch();
        std::thread stopper([&] { server->stop(5s, go_to); });
        Farewell told = farewell(*viewer);
        EXPECT_EQ(viewer->closeCode(), 1001);
        stopper.join();
        return told;
    }
};

TEST_F(ElsewhereTest, AFullServerNamesAnother) {
    max_viewers = 1;
    serve();
    const auto viewer = watch();
    Farewell told = turnedAway();
    EXPECT_EQ(told.go_to, "") << "there is none";
    EXPECT_EQ(told.retry_after_s, 5);
    server->setElsewhere([this] { return next; });
    told = turnedAway();
    EXPECT_EQ(told.go_to, "https://b.example/");
    EXPECT_EQ(told.retry_after_s, 0) << "at once";
    next = "";
    told = turnedAway();
    EXPECT_EQ(told.go_to, "") << "the others are full, too";
    EXPECT_EQ(told.retry_after_s, 5);
    viewer->pose(1);
    EXPECT_TRUE(viewer->next<wire::Frame>()) << "who has a place stays";
}

TEST_F(ElsewhereTest, AServerThatStopsSendsItsViewersThere) {
    serve();
    server->setElsewhere([] { return std::string("https://b.example/"); });
    const Farewell told = stopped("");
    EXPECT_EQ(told.go_to, "https://b.example/");
    EXPECT_GT(told.retry_after_s, 0);
}

TEST_F(ElsewhereTest, WhatItIsToldToSayGoesFirst) {
    serve();
    server->setElsewhere([] { return std::string("https://b.example/"); });
    EXPECT_EQ(stopped("wss://given.example/ws").go_to, "wss://given.example/ws");
}

TEST_F(ElsewhereTest, ADrainSendsNobodyAway) {
    serve();
    server->setElsewhere([] { return std::string("https://b.example/"); });
    const auto viewer = watch();
    server->drain();
    viewer->pose(1);
    EXPECT_TRUE(viewer->next<wire::Frame>());
    EXPECT_TRUE(watch());
}

TEST_F(ElsewhereTest, MayChangeWhileViewersAreTurnedAway) {
    max_viewers = 1;
    options.threads = 3;
    serve();
    const auto viewer = watch();
    std::atomic<bool> done{false};
    std::thread changer([&] {
        while (!done) {
            const auto url = std::make_unique<std::string>("https://b.example/");
            server->setElsewhere([&url] { return *url; });
            server->setElsewhere({}); // after this nobody reads `url`
        }
    });
    for (int i = 0; i < 20; ++i) {
        const Farewell told = turnedAway();
        EXPECT_EQ(told.go_to.empty(), told.retry_after_s > 0);
    }
    done = true;
    changer.join();
}

} // namespace
} // namespace brume::test

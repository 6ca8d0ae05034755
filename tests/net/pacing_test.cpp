// What the server makes of a viewer's link, over a real socket: pings, silence, and a lost connection that comes back.
#include "tests/net/session_fixture.h"

namespace brume::test {
namespace {

std::string resumeKey(WsClient& client, const char* key = nullptr, uint32_t* viewer = nullptr,
                      bool* resumed = nullptr) {
    client.say([&](auto& b) { return wire::CreateHelloDirect(b, "test client", 64, 48, 1, 0, key); });
    const auto message = client.next<wire::Welcome>();
    if (!message) return {};
    const auto* welcome = message->parsed->as<wire::Welcome>();
    if (viewer) *viewer = welcome->viewer();
    if (resumed) *resumed = welcome->resumed();
    return welcome->resume() ? welcome->resume()->str() : "";
}

TEST_F(SessionTest, ViewersArePingedAndTheirLinkIsKnown) {
    serve();
    const auto client = watch();
    for (int i = 0; i < 3; ++i) {
        const auto ping = client->next<wire::Ping>();
        ASSERT_TRUE(ping);
        const auto* at = ping->parsed->as<wire::Ping>();
        std::this_thread::sleep_for(5ms);
        client->say([&](auto& b) { return wire::CreatePong(b, at->nonce(), at->time_us()); });
        client->say([&](auto& b) { return wire::CreatePong(b, at->nonce() + 1000, 0); }); // never asked for
    }
    std::vector<std::shared_ptr<Viewer>> viewers;
    audience->list(viewers);
    ASSERT_EQ(viewers.size(), 1u);
    EXPECT_TRUE(eventually([&] { return viewers[0]->link().round_trip_ms >= 5; }));
    EXPECT_LT(viewers[0]->link().round_trip_ms, 1000);
}

// Pings are answered by the program at the other end when it has time. What the link does, the kernel knows.
TEST_F(SessionTest, ABusyProgramKeepsItsQuality) {
    serve();
    const auto client = watch();
    std::vector<std::shared_ptr<Viewer>> viewers;
    audience->list(viewers);
    ASSERT_EQ(viewers.size(), 1u);
    float longest = 0;
    for (uint32_t i = 0; i < 12; ++i) {
        client->pose(1 + i, {float(i), 0, 10});
        const auto frame = client->next<wire::Frame>();
        const auto ping = client->next<wire::Ping>();
        ASSERT_TRUE(frame && ping);
        client->ack(frame->parsed->as<wire::Frame>()->id());
        if (i > 2) std::this_thread::sleep_for(150ms);
        const auto* at = ping->parsed->as<wire::Ping>();
        client->say([&](auto& b) { return wire::CreatePong(b, at->nonce(), at->time_us()); });
        EXPECT_EQ(viewers[0]->link().level, 0u) << i;
        longest = std::max(longest, viewers[0]->link().queue_ms);
    }
    EXPECT_LT(longest, 50);
}

TEST_F(SessionTest, AHiddenWindowGetsNothingAndStaysAndIsServedAgain) {
    options.silence = 300ms;
    serve();
    const auto client = watch();
    client->pose(1);
    ASSERT_TRUE(client->next<wire::Frame>());
    ASSERT_TRUE(client->next<wire::Frame>()); // the window is full, and nothing is acknowledged
    client->pose(2, {0, 0, 10}, 0, 0, true);
    ASSERT_TRUE(client->next<wire::Ping>());
    const uint64_t made = renderer->made; // two, or more where one replaced another before it was sent
    for (int i = 0; i < 5; ++i)
        ASSERT_TRUE(client->next<wire::Ping>()) << "200 ms apart, longer than the silence allowed";
    EXPECT_EQ(renderer->made, made);
    client->pose(3);
    EXPECT_TRUE(frameOf(*client, 3));
}

TEST_F(SessionTest, WhoAcknowledgesNothingIsClosedAndMayComeBack) {
    options.silence = 600ms;
    serve();
    const auto keen = watch();
    keen->pose(1);
    uint32_t first = 0, again = 0;
    bool resumed = true;
    std::string key;
    {
        WsClient silent(server->port());
        key = resumeKey(silent, nullptr, &first, &resumed);
        EXPECT_EQ(key.size(), 32u);
        EXPECT_FALSE(resumed);
        silent.pose(77, {4, 5, 6});
        ASSERT_TRUE(silent.next<wire::Frame>());
        const auto goodbye = silent.next<wire::Goodbye>();
        ASSERT_TRUE(goodbye);
        EXPECT_NE(goodbye->parsed->as<wire::Goodbye>()->reason()->str().find("acknowledged"), std::string::npos);
        EXPECT_GT(goodbye->parsed->as<wire::Goodbye>()->retry_after_s(), 0);
    }
    WsClient back(server->port());
    EXPECT_NE(resumeKey(back, key.c_str(), &again, &resumed), key) << "a key is good once";
    EXPECT_TRUE(resumed);
    EXPECT_EQ(again, first);
    const auto frame = back.next<wire::Frame>(); // of the pose that it had, without another
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->parsed->as<wire::Frame>()->position()->y(), 5);
    back.pose(1, {7, 8, 9}); // numbers may begin anew
    ASSERT_TRUE(frameOf(back, 1));
    ASSERT_TRUE(frameOf(*keen, 1));
}

TEST_F(SessionTest, ALostConnectionComesBackAndAStrangersKeyDoesNot) {
    serve();
    uint32_t first = 0, again = 0, stranger = 0;
    bool resumed = true;
    std::string key;
    {
        WsClient lost(server->port());
        key = resumeKey(lost, nullptr, &first);
        lost.pose(5, {1, 2, 3});
        ASSERT_TRUE(lost.next<wire::Frame>());
        lost.socket.reset();
    }
    ASSERT_TRUE(eventually([&] { return audience->size() == 0; }));
    WsClient other(server->port());
    resumeKey(other, std::string(32, 'a').c_str(), &stranger, &resumed);
    EXPECT_FALSE(resumed);
    EXPECT_NE(stranger, first);
    WsClient back(server->port());
    resumeKey(back, key.c_str(), &again, &resumed);
    EXPECT_TRUE(resumed);
    EXPECT_EQ(again, first);
    ASSERT_TRUE(back.next<wire::Frame>());
    WsClient thief(server->port()); // the key was used
    resumeKey(thief, key.c_str(), &stranger, &resumed);
    EXPECT_FALSE(resumed);
}

TEST_F(SessionTest, WhoSaidGoodbyeDoesNotComeBack) {
    serve();
    bool resumed = true;
    std::string key;
    {
        WsClient client(server->port());
        key = resumeKey(client);
        client.say([](auto& b) { return wire::CreateGoodbye(b); });
        EXPECT_EQ(client.closeCode(), 1000);
    }
    WsClient again(server->port());
    resumeKey(again, key.c_str(), nullptr, &resumed);
    EXPECT_FALSE(resumed);
}

// The device's time decides, not only the number of places.
TEST_F(SessionTest, NobodyIsLetInWhoWouldMakeItTooSlow) {
    serve();
    const auto first = watch();
    audience->setTimeFor(1);
    WsClient second(server->port());
    second.hello();
    EXPECT_EQ(nextError(second), wire::ErrorCode::full);
    const auto goodbye = second.next<wire::Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_NE(goodbye->parsed->as<wire::Goodbye>()->reason()->str().find("no time"), std::string::npos);
    EXPECT_GT(goodbye->parsed->as<wire::Goodbye>()->retry_after_s(), 0);
    audience->setTimeFor(2);
    EXPECT_TRUE(watch());
}

} // namespace
} // namespace brume::test

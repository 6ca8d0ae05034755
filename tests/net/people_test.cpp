// People over real sockets: who is here, following, and presenting.
#include "server/net/token.h"
#include "tests/net/session_fixture.h"

namespace brume::test {
namespace {

struct PeopleNetTest : ServerTest {
    std::unique_ptr<WsClient> come(const char* name, float x, uint16_t width = 640) {
        auto client = watch(width);
        client->pose(1, {x, 0, 10});
        client->say([&](auto& b) { return wire::CreatePresenceDirect(b, name, nullptr, 0, true); });
        return client;
    }
    // The next People message of which the condition holds.
    template <class Condition>
    static std::unique_ptr<Received> peopleWhere(WsClient& client, const Condition& holds) {
        for (int i = 0; i < 100; ++i) {
            while (auto message = client.receive()) {
                if (!message->parsed) continue;
                if (const auto* frame = message->parsed->as<wire::Frame>()) client.ack(frame->id());
                const auto* people = message->parsed->as<wire::People>();
                if (people && holds(*people)) return message;
            }
        }
        return nullptr;
    }
    static const wire::Person* named(const wire::People& people, std::string_view name) {
        for (const wire::Person* one : *people.people())
            if (one->name()->string_view() == name) return one;
        return nullptr;
    }
    // The next frame whose camera stands there.
    static std::unique_ptr<Received> frameAt(WsClient& client, float x) {
        for (int i = 0; i < 1000; ++i) {
            auto message = client.next<wire::Frame>();
            if (!message) return nullptr;
            const auto* frame = message->parsed->as<wire::Frame>();
            client.ack(frame->id());
            if (frame->position()->x() == x) return message;
        }
        return nullptr;
    }
};

TEST_F(PeopleNetTest, AllAreToldWhoIsHere) {
    serve();
    const auto ann = come("Ann", 1), bob = come("<b>Bob</b>", 2);
    const auto told = peopleWhere(*ann, [&](const wire::People& people) {
        const wire::Person* other = named(people, "<b>Bob</b>");
        return people.count() == 2 && other && other->look();
    });
    ASSERT_TRUE(told);
    const auto& people = *told->parsed->as<wire::People>();
    EXPECT_EQ(people.presenter(), 0u);
    EXPECT_FALSE(named(people, "Ann")->known());
    EXPECT_EQ(named(people, "<b>Bob</b>")->look()->position().x(), 2);
    const std::string list = get(server->port(), "/viewers").body;
    EXPECT_NE(list.find("\"name\":\"<b>Bob</b>\""), std::string::npos) << list;
    EXPECT_NE(list.find("\"presenter\":0"), std::string::npos) << list;
}

TEST_F(PeopleNetTest, WhoSaidNothingIsToldNothing) {
    serve();
    const auto old = watch(); // older than Presence
    old->pose(1);
    const auto ann = come("Ann", 1);
    ASSERT_TRUE(peopleWhere(*ann, [](const wire::People& people) { return people.count() == 2; }));
    const auto frame = frameOf(*old, 1);
    ASSERT_TRUE(frame);
    EXPECT_FALSE(old->next<wire::People>(300ms));
}

TEST_F(PeopleNetTest, FollowersGetTheLeadersPictures) {
    serve();
    const auto ann = come("Ann", 1, 800), bob = come("Bob", 2);
    const auto told = peopleWhere(*bob, [&](const wire::People& people) { return named(people, "Ann"); });
    ASSERT_TRUE(told);
    const uint32_t leader = named(*told->parsed->as<wire::People>(), "Ann")->id();
    bob->say([&](auto& b) { return wire::CreatePresenceDirect(b, "Bob", nullptr, leader); });
    auto seen = frameAt(*bob, 1);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->parsed->as<wire::Frame>()->follows(), leader);
    EXPECT_EQ(seen->parsed->as<wire::Frame>()->width(), 800);
    ann->pose(2, {3, 0, 10});
    EXPECT_TRUE(frameAt(*bob, 3));
    bob->pose(2, {5, 0, 10});
    bob->say([&](auto& b) { return wire::CreatePresenceDirect(b, "Bob"); });
    seen = frameAt(*bob, 5);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->parsed->as<wire::Frame>()->follows(), 0u);
    EXPECT_EQ(seen->parsed->as<wire::Frame>()->width(), 640);
}

TEST_F(PeopleNetTest, PresentingEndsWhenThePresenterGoes) {
    serve();
    auto ann = come("Ann", 1);
    const auto bob = come("Bob", 2);
    const auto told = peopleWhere(*ann, [&](const wire::People& people) { return named(people, "Ann"); });
    ASSERT_TRUE(told);
    const uint32_t id = named(*told->parsed->as<wire::People>(), "Ann")->id();
    ann->say([&](auto& b) { return wire::CreateLead(b, id + 100); });
    EXPECT_EQ(nextError(*ann), wire::ErrorCode::unknown_name);
    ann->say([&](auto& b) { return wire::CreateLead(b, id); });
    ASSERT_TRUE(peopleWhere(*bob, [&](const wire::People& people) { return people.presenter() == id; }));
    EXPECT_TRUE(frameAt(*bob, 1));
    ann.reset();
    ASSERT_TRUE(peopleWhere(*bob, [&](const wire::People& people) { return people.presenter() == 0; }));
    EXPECT_TRUE(frameAt(*bob, 2));
}

} // namespace
} // namespace brume::test

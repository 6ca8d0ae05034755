// Viewers who draw by themselves: the lit medium as a stream, beside viewers who get pictures.
#include <gtest/gtest.h>

#include "client/native/lit_reader.h"
#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test::lit_test {
namespace {

// A viewer who draws by itself, and keeps what it gets.
class Drawer {
public:
    explicit Drawer(const client::Endpoint& server, uint8_t hz, bool pose = true)
        : session(server, wishes(hz), milliseconds(5000)) {
        const auto until = std::chrono::steady_clock::now() + kPatience;
        while (!session.welcomed() && !session.closed() && std::chrono::steady_clock::now() < until) poll();
        if (session.welcomed() && pose) session.sendPose(kFromFront);
    }
    void poll(milliseconds timeout = milliseconds(10)) {
        while (const auto message = session.next(timeout)) {
            timeout = milliseconds(0);
            if (const auto* lit = message->as<wire::LitParticles>()) {
                const lit::Rows* rows = reader.read(*lit, message->parsed().jpeg);
                ASSERT_TRUE(rows) << reader.why();
                if (acknowledging) session.acknowledge(lit->id());
                numbers.push_back(lit->number());
                whole += lit->reference() == 0;
                hashes[lit->tick()] = lit->state_hash();
                places[lit->tick()] = rows->columns[lit::kPlace];
                count = lit->count();
                objects = lit->objects() ? lit->objects()->size() : 0;
                measured = lit->measured(), predicted = lit->predicted();
                bytes += message->size();
            } else if (const auto* frame = message->as<wire::Frame>()) {
                if (acknowledging) session.acknowledge(frame->id());
                ++pictures;
            } else if (const auto* state = message->as<wire::SceneState>()) {
                not_drawable = state->not_drawable() ? state->not_drawable()->str() : "";
                tick = state->tick();
                paused = state->paused();
                state_hash = state->state_hash();
            }
        }
    }

    client::Session session;
    client::LitReader reader;
    bool acknowledging = true;
    std::vector<uint32_t> numbers;
    std::map<uint64_t, uint64_t> hashes;
    std::map<uint64_t, std::vector<uint16_t>> places; // along x, by tick
    size_t whole = 0, pictures = 0, bytes = 0, objects = 0;
    uint32_t count = 0;
    float measured = 0, predicted = 0;
    std::optional<std::string> not_drawable;
    uint64_t tick = 0, state_hash = 0;
    bool paused = false;

private:
    static client::Wishes wishes(uint8_t hz) {
        client::Wishes all = kSmall;
        all.draw_hz = hz;
        return all;
    }
};

bool until(std::initializer_list<Drawer*> drawers, const std::function<bool()>& holds) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (!holds()) {
        if (std::chrono::steady_clock::now() > end) return false;
        for (Drawer* one : drawers) one->poll();
    }
    return true;
}

void addFog(client::Session& session) {
    session.sendCommand<wire::Add>([&](auto& b) {
        const std::vector changes{wire::CreateChangeDirect(b, "fog.extinction", 0.02)};
        return wire::CreateAddDirect(b, "fog", &changes);
    });
}

TEST(LitStream, AllWhoDrawHaveTheSameMediumInTheSameTick) {
    RunningServer server({"--scene", "plume", "--ahead", "off", "--lit-rate", "100000"});
    const auto begin = std::chrono::steady_clock::now();
    Drawer fast(server.endpoint(), 60), slow(server.endpoint(), 10);
    Watcher looker(server.endpoint()); // who gets pictures
    looker.look(kFromFront);
    ASSERT_TRUE(until({&fast, &slow}, [&] {
        looker.poll(milliseconds(0));
        return fast.numbers.size() > 60 && slow.numbers.size() > 8 && looker.frames.size() > 5;
    }));
    // On a busy machine there are fewer messages than anyone asks for, and both get all of them.
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    EXPECT_LE(double(slow.numbers.size()), 10 * seconds + 2);
    EXPECT_GE(fast.numbers.size(), slow.numbers.size());
    EXPECT_EQ(fast.pictures + slow.pictures, 0u);
    EXPECT_GT(fast.count, 4000u);
    EXPECT_EQ(fast.objects, 1u) << "the ground";
    EXPECT_LT(fast.whole, fast.numbers.size() / 3);
    size_t common = 0, seen = 0;
    for (const auto& [tick, hash] : slow.hashes) {
        if (const auto same = fast.hashes.find(tick); same != fast.hashes.end()) {
            EXPECT_EQ(same->second, hash);
            EXPECT_EQ(fast.places[tick], slow.places[tick]);
            ++common;
        }
        if (const auto shown = looker.hashes.find(tick); shown != looker.hashes.end()) {
            EXPECT_EQ(shown->second, hash) << "of a picture";
            ++seen;
        }
    }
    EXPECT_GT(common, 4u);
}

// A scene that viewers cannot draw comes as pictures; so does one that becomes such, and back.
TEST(LitStream, PicturesComeWhileViewersCannotDraw) {
    RunningServer server({"--ahead", "off", "--set", "medium.count=50"});
    Drawer drawer(server.endpoint(), 30);
    ASSERT_TRUE(until({&drawer}, [&] { return drawer.numbers.size() > 3 && drawer.not_drawable; }));
    EXPECT_EQ(*drawer.not_drawable, "");
    EXPECT_EQ(drawer.pictures, 0u);
    addFog(drawer.session);
    ASSERT_TRUE(until({&drawer}, [&] { return drawer.pictures > 2; }));
    ASSERT_TRUE(until({&drawer}, [&] { return *drawer.not_drawable == "it has fog"; }));
    const size_t before = drawer.numbers.size();
    drawer.session.sendCommand<wire::Remove>([&](auto& b) { return wire::CreateRemoveDirect(b, "fog[0]"); });
    ASSERT_TRUE(until({&drawer}, [&] { return drawer.numbers.size() > before + 3; }));
    EXPECT_TRUE(until({&drawer}, [&] { return drawer.not_drawable->empty(); }));
}

// A medium at rest is told once to each, whenever he comes.
TEST(LitStream, AMediumAtRestIsToldOnce) {
    RunningServer server({"--ahead", "off", "--set", "simulation.paused=true"});
    Drawer first(server.endpoint(), 30);
    ASSERT_TRUE(until({&first}, [&] { return !first.numbers.empty(); }));
    Drawer second(server.endpoint(), 30);
    ASSERT_TRUE(until({&first, &second}, [&] { return !second.numbers.empty() && first.tick > 0; }));
    const size_t told = first.numbers.size();
    const auto end = std::chrono::steady_clock::now() + milliseconds(1500);
    while (std::chrono::steady_clock::now() < end) first.poll(), second.poll();
    EXPECT_LE(first.numbers.size(), told + 1);
    EXPECT_EQ(second.numbers.size(), 1u);
    EXPECT_EQ(second.count, 500u);
}

// Whatever its pace, and though it was hidden meanwhile, everybody gets the state in which the scene rests.
TEST(LitStream, EveryoneGetsTheStateAtRest) {
    RunningServer server({"--ahead", "off"});
    Drawer fast(server.endpoint(), 60), slow(server.endpoint(), 5), hidden(server.endpoint(), 30, false);
    hidden.session.sendPose(kFromFront, 0, 0, true);
    ASSERT_TRUE(until({&fast, &slow, &hidden}, [&] { return fast.numbers.size() > 20 && slow.numbers.size() > 2; }));
    fast.session.sendImpulse({.origin = {-60, 16, 0}, .direction = {1, -0.25f, 0}, .strength = 3});
    fast.session.sendPaused(true);
    const auto last = [](const Drawer& one) { return one.hashes.empty() ? 0 : one.hashes.rbegin()->second; };
    ASSERT_TRUE(until({&fast, &slow, &hidden}, [&] { return fast.paused && slow.paused; }));
    hidden.session.sendPose(kFromFront);
    EXPECT_TRUE(until({&fast, &slow, &hidden}, [&] {
        return last(fast) == fast.state_hash && last(slow) == fast.state_hash && last(hidden) == fast.state_hash;
    }));
}

// Who acknowledges nothing gets a window of messages, and delays nobody; who is hidden gets none.
TEST(LitStream, AWindowBoundsWhatIsOnItsWay) {
    RunningServer server({"--scene", "plume", "--ahead", "off"});
    Drawer silent(server.endpoint(), 30), other(server.endpoint(), 30);
    silent.acknowledging = false;
    ASSERT_TRUE(until({&silent, &other}, [&] { return other.numbers.size() > 40; }));
    EXPECT_LE(silent.numbers.size(), 6u);
    Drawer hidden(server.endpoint(), 30, false);
    hidden.session.sendPose(kFromFront, 0, 0, true);
    ASSERT_TRUE(until({&hidden, &other}, [&] { return other.numbers.size() > 60; }));
    EXPECT_TRUE(hidden.numbers.empty());
    hidden.session.sendPose(kFromFront);
    EXPECT_TRUE(until({&hidden, &other}, [&] { return hidden.numbers.size() > 2; }));
}

TEST(LitStream, TheRateOfBytesIsKept) {
    RunningServer server({"--scene", "plume", "--ahead", "off", "--lit-rate", "400"});
    Drawer drawer(server.endpoint(), 30);
    ASSERT_TRUE(until({&drawer}, [&] { return drawer.numbers.size() > 20; }));
    const size_t bytes = drawer.bytes, count = drawer.numbers.size();
    const uint64_t begin = drawer.places.rbegin()->first;
    ASSERT_TRUE(until({&drawer}, [&] { return drawer.numbers.size() > count + 20; }));
    const double seconds = double(drawer.places.rbegin()->first - begin) / 60;
    EXPECT_LT(double(drawer.bytes - bytes) / seconds, 460e3);
    EXPECT_GT(double(drawer.bytes - bytes) / seconds, 100e3);
}

TEST(LitStream, WhoDrawsTakesNoPlaceOfPicturesAndHasALimit) {
    RunningServer server({"--ahead", "off", "--max-viewers", "1", "--max-drawing-viewers", "4"});
    Watcher looker(server.endpoint());
    looker.look(kFromFront);
    Drawer a(server.endpoint(), 30), b(server.endpoint(), 30), c(server.endpoint(), 30), d(server.endpoint(), 30);
    ASSERT_TRUE(until({&a, &b, &c, &d}, [&] {
        looker.poll(milliseconds(0));
        return a.numbers.size() > 2 && b.numbers.size() > 2 && c.numbers.size() > 2;
    }));
    EXPECT_FALSE(d.session.welcomed()) << "three quarters of the places are one address's";
    EXPECT_NE(d.session.closedBecause().find("places to draw"), std::string::npos) << d.session.closedBecause();
}

TEST(LitStream, TheErrorOfWhatViewersDrawIsMeasured) {
    RunningServer server({"--ahead", "off", "--measure-error", "0.5"});
    Drawer drawer(server.endpoint(), 30);
    ASSERT_TRUE(until({&drawer}, [&] { return drawer.measured > 0; }));
    EXPECT_LT(drawer.measured, 0.02f);
    EXPECT_GT(drawer.measured, 0.003f) << "eight slabs and a quadratic fit are not exact";
    EXPECT_TRUE(until({&drawer}, [&] { return drawer.predicted > 0; }));
    EXPECT_TRUE(until({&drawer}, [&] {
        return get(server.port(), "/viewers").body.find("\"viewer\":{\"relative_rmse\"") != std::string::npos;
    }));
}

} // namespace
} // namespace brume::test::lit_test

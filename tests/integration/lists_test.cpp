// Fogs, points and spots that viewers change, add and remove while the server runs.
#include <gtest/gtest.h>

#include "common/scene_text.h"
#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test {
namespace {

const Pose kPose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);
constexpr size_t kLights = 0, kFogs = 1; // places in Welcome.lists

void add(Watcher& watcher, const char* list, const char* path, double value) {
    watcher.session.sendCommand<wire::Add>([&](auto& b) {
        const std::vector changes{wire::CreateChangeDirect(b, path, value)};
        return wire::CreateAddDirect(b, list, &changes);
    });
}
void remove(Watcher& watcher, const char* path) {
    watcher.session.sendCommand<wire::Remove>([&](auto& b) { return wire::CreateRemoveDirect(b, path); });
}
void set(Watcher& watcher, const char* path, double value) {
    watcher.session.sendCommand<wire::Set>([&](auto& b) {
        const std::vector changes{wire::CreateChangeDirect(b, path, value)};
        return wire::CreateSetDirect(b, &changes);
    });
}

// A small cloud that stands still, watched by two.
class ListsOfAServer : public testing::Test {
protected:
    RunningServer server{{"--ahead", "off", "--most-frame-time", "60000", "--set", "simulation.paused=true", "--set",
                          "medium.count=50", "--set", "render.method=slabs", "--set", "render.rate=8"}};
    Watcher a{server.endpoint()}, b{server.endpoint()};
    const std::vector<Watcher*> both{&a, &b};

    void SetUp() override {
        for (Watcher* one : both) one->look(kPose);
        ASSERT_TRUE(watch(both, [&] { return a.lists.size() == 2 && b.lists.size() == 2; }));
    }
    Scene saved() const { return sceneOf(get(server.port(), "/scene.toml").body, "saved.toml"); }
    // A picture of the scene once it has, or has not, lights and fogs.
    client::Picture pictureWith(bool lights, bool fogs) {
        EXPECT_TRUE(
            watch(both, [&] { return a.lists.at(kLights).empty() != lights && a.lists.at(kFogs).empty() != fogs; }));
        HttpReply reply; // 503 while shaders are compiled, which may take longer than a reply
        for (int tries = 0; reply.status != 200 && tries < 6; ++tries)
            reply = get(server.port(), "/snapshot.jpg?w=160&h=90");
        EXPECT_EQ(reply.status, 200) << reply.body;
        return decoded({reply.body.begin(), reply.body.end()}, 160, 90);
    }
};

TEST_F(ListsOfAServer, ElementsAreChangedAddedAndRemovedForEveryone) {
    const client::Picture bare = pictureWith(false, false);
    add(a, "fog", "fog.extinction", 0.05);
    const client::Picture foggy = pictureWith(false, true);
    EXPECT_GT(difference(foggy, bare), 3) << "the first fog, which needs other shaders and another method perhaps";
    ASSERT_TRUE(watch(both, [&] { return !b.lists.at(kFogs).empty(); }));
    EXPECT_EQ(b.lists[kFogs][0], 0.05f) << "its extinction is the first of its settings";

    set(b, "fog[0].extinction", 0.02);
    ASSERT_TRUE(watch(both, [&] { return a.lists[kFogs][0] == 0.02f && a.lists == b.lists; }));
    ASSERT_TRUE(watch(both, [&] { return a.state_tick > a.lists_tick + 120; }));
    EXPECT_EQ(a.lists[kFogs][0], 0.02f) << "states go on without lists that have not changed";

    add(a, "light", "light.range", 50);
    const client::Picture lit = pictureWith(true, true);
    EXPECT_GT(difference(lit, foggy), 1);
    remove(b, "light[0]");
    remove(b, "fog[0]");
    EXPECT_LT(difference(pictureWith(false, false), bare), 0.5) << "without the last one all is as it was";
    EXPECT_TRUE(a.errors.empty());
    EXPECT_TRUE(b.errors.empty());
}

TEST_F(ListsOfAServer, WhatCannotBeIsRefusedToWhoAskedAndSaid) {
    set(a, "fog[3].extinction", 1);
    add(a, "fog", "fog.lo", 40'000);
    set(a, "fog[0].hi", 30'000);
    ASSERT_TRUE(watch(both, [&] { return a.errors.size() == 2; }));
    EXPECT_EQ(a.errors[0].text, "there is no fog[3]: there is none at all");
    EXPECT_EQ(a.errors[0].code, wire::ErrorCode::out_of_range);
    EXPECT_EQ(a.errors[1].text, "fog[0]: lo must be below hi");
    EXPECT_EQ(a.errors[1].input_seq, a.errors[0].input_seq + 2) << "the one between was taken";
    EXPECT_TRUE(b.errors.empty());
    for (int i = 0; i < 4; ++i) add(a, "fog", "fog.radius", 1);
    ASSERT_TRUE(watch(both, [&] { return a.errors.size() == 3; }));
    EXPECT_EQ(a.errors[2].text, "there are 4 already, 4 is the most: remove one first");
    EXPECT_EQ(saved().fogs.size(), 4u);
}

TEST_F(ListsOfAServer, AreSavedAndRestarted) {
    add(a, "light", "light.orbit", 0.5);
    add(a, "fog", "fog.radius", 3);
    ASSERT_TRUE(watch(both, [&] { return !a.lists.at(kLights).empty() && !a.lists.at(kFogs).empty(); }));
    EXPECT_EQ(saved().fogs[0].radius, 3);
    EXPECT_EQ(localLightsOf(saved())[0].orbit, 0.5f);
    EXPECT_EQ(saved().lights.size(), 2u) << "the directional one is there, too";
    a.session.sendCommand<wire::Restart>([](auto& to) { return wire::CreateRestart(to); });
    ASSERT_TRUE(watch(both, [&] { return a.lists.at(kLights).empty() && a.lists.at(kFogs).empty(); }));
    EXPECT_TRUE(saved().fogs.empty());
}

} // namespace
} // namespace brume::test

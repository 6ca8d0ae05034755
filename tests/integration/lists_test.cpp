// Fogs, points, spots and objects that viewers change, add and remove while the server runs.
#include <filesystem>
#include <fstream>
#include <future>

#include <gtest/gtest.h>

#include "common/scene_text.h"
#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"

namespace brume::test::lists_test {
namespace {

const Pose kPose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);
constexpr size_t kLights = 0, kFogs = 1, kBoxes = 3, kLists = 5; // places in Welcome.lists, and their number

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
    RunningServer server{{"--ahead", "off", "--set", "simulation.paused=true", "--set", "medium.count=50", "--set",
                          "render.method=slabs", "--set", "render.rate=8"}};
    Watcher a{server.endpoint()}, b{server.endpoint()};
    const std::vector<Watcher*> both{&a, &b};

    void SetUp() override {
        for (Watcher* one : both) one->look(kPose);
        ASSERT_TRUE(watch(both, [&] { return a.lists.size() == kLists && b.lists.size() == kLists; }));
    }
    Scene saved() const { return sceneOf(get(server.port(), "/scene.toml").body, "saved.toml"); }
    // A picture of the scene once it has, or has not, lights and fogs.
    client::Picture pictureWith(bool lights, bool fogs) {
        EXPECT_TRUE(
            watch(both, [&] { return a.lists.at(kLights).empty() != lights && a.lists.at(kFogs).empty() != fogs; }));
        HttpReply reply; // 503 while shaders are compiled, which may take longer than a reply
        for (int tries = 0; reply.status != 200 && tries < 6; ++tries) {
            const auto ask = [&] { return get(server.port(), "/snapshot.jpg?w=160&h=90"); };
            auto snapshot = std::async(std::launch::async, ask);
            const auto came = [&] { return snapshot.wait_for(std::chrono::seconds(0)) == std::future_status::ready; };
            EXPECT_TRUE(watch(both, came)); // who answers no pings is taken for gone
            reply = snapshot.get();
        }
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

// One who may change the scene adds lights as fast as is allowed: pictures still come.
TEST(ListsOfABusyServer, MoreLightThanThereIsTimeForIsRefused) {
    RunningServer server(
        {"--ahead", "off", "--set", "render.method=slabs", "--set", "render.rate=8", "--most-frame-time", "20"});
    Watcher a(server.endpoint());
    a.look(kPose);
    ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty() && a.lists.size() == kLists; }));
    for (int i = 0; i < 64; ++i) add(a, "light", "light.range", 50);
    ASSERT_TRUE(watch({&a}, [&] { return !a.errors.empty() && !a.lists.at(kLights).empty(); }));
    EXPECT_NE(a.errors.front().text.find("--most-frame-time"), std::string::npos) << a.errors.front().text;
    const uint64_t tick = a.last().tick;
    ASSERT_TRUE(watch({&a}, [&] { return a.last().tick > tick + 60; }));
    const size_t lights = a.lists.at(kLights).size();
    remove(a, "light[0]");
    ASSERT_TRUE(watch({&a}, [&] { return a.lists.at(kLights).size() < lights; })) << "what lessens it is taken";
}

// Boxes in the sun throw shadows through the medium, which each pixel looks for.
TEST(ListsOfABusyServer, MoreObjectsThanThereIsTimeForAreRefused) {
    RunningServer server(
        {"--ahead", "off", "--set", "render.method=slabs", "--set", "render.rate=8", "--most-frame-time", "5"});
    Watcher a(server.endpoint());
    a.look(kPose);
    ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty() && a.lists.size() == kLists; }));
    size_t seen = 0;
    ASSERT_TRUE(watch({&a}, [&] {
        for (; seen < a.frames.size() && a.errors.empty(); ++seen) add(a, "box", "box.yaw", 1);
        return !a.errors.empty();
    }));
    EXPECT_NE(a.errors.front().text.find("--most-frame-time"), std::string::npos) << a.errors.front().text;
    const uint64_t tick = a.last().tick;
    ASSERT_TRUE(watch({&a}, [&] { return a.last().tick > tick + 60; })) << "pictures still come";
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

TEST_F(ListsOfAServer, ABoxIsAddedMovedAndRemovedForEveryone) {
    const client::Picture bare = pictureWith(false, false);
    const auto place = [&](const wire::Vec3& centre) {
        const wire::Vec3 size(6, 6, 1);
        b.session.sendCommand<wire::Set>([&](auto& to) {
            const std::vector changes{wire::CreateChangeDirect(to, "box[0].centre", {}, &centre),
                                      wire::CreateChangeDirect(to, "box[0].size", {}, &size)};
            return wire::CreateSetDirect(to, &changes);
        });
        EXPECT_TRUE(watch(both, [&] { return a.lists[kBoxes].at(0) == centre.x() && a.lists == b.lists; }));
        return pictureWith(false, false);
    };
    add(a, "box", "box.yaw", 0.5);
    ASSERT_TRUE(watch(both, [&] { return !b.lists.at(kBoxes).empty() && !a.lists.at(kBoxes).empty(); }));
    const client::Picture left = place({-4, 0, 8});
    EXPECT_GT(difference(left, bare), 3);
    EXPECT_GT(difference(place({4, 0, 8}), left), 3);
    ASSERT_EQ(saved().boxes.size(), 1u);
    EXPECT_EQ(saved().boxes[0], (Box{.centre = {4, 0, 8}, .size = {6, 6, 1}, .yaw = 0.5f}));
    remove(a, "box[0]");
    ASSERT_TRUE(watch(both, [&] { return b.lists[kBoxes].empty(); }));
    EXPECT_LT(difference(pictureWith(false, false), bare), 0.5);
    EXPECT_TRUE(a.errors.empty());
    EXPECT_TRUE(b.errors.empty());
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

// A server whose driver has no shader compiled, and compiles those of the first fog and of the first light.
class ListsOfAColdServer : public testing::Test {
protected:
    using Clock = std::chrono::steady_clock;
    static constexpr milliseconds kCompiled{240'000}; // longer than anything takes to compile

    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("brume-cold-" + std::to_string(getpid()));
    const std::filesystem::path recording = folder / "session", scene = folder / "small.toml";
    std::unique_ptr<RunningServer> server;
    std::unique_ptr<Watcher> watcher;
    std::unique_ptr<client::Picture> bare;

    void SetUp() override {
        if (!whole()) GTEST_SKIP() << "it compiles all shaders anew, which takes minutes";
        std::filesystem::create_directories(folder / "cache");
        std::ofstream(scene) << "[medium]\ncount = 50\n[render]\nmethod = \"slabs\"\nrate = 8\n";
        server = std::make_unique<RunningServer>(
            std::vector<std::string>{"--ahead", "background", "--scene", scene.string(), "--record", recording.string(),
                                     "--measure-error", "0"},
            std::vector<std::string>{"MESA_SHADER_CACHE_DIR=" + (folder / "cache").string()});
        watcher = std::make_unique<Watcher>(server->endpoint());
        watcher->look(kPose);
        ASSERT_TRUE(watch({watcher.get()}, [&] { return watcher->frames.size() > 10; }));
        bare = std::make_unique<client::Picture>(pictureOf(watcher->last()));
    }
    void TearDown() override {
        watcher.reset();
        server.reset();
        std::filesystem::remove_all(folder);
    }
    // Watches until the newest picture is as `wanted` says by its difference from the bare scene's. Returns the longest
    // time without a frame, and the whole.
    struct Waited {
        double longest = 0, all = 0; // s
    };
    Waited watchUntil(const std::function<bool(double)>& wanted) {
        Waited waited;
        const Clock::time_point begun = Clock::now();
        Clock::time_point last = begun;
        size_t seen = watcher->frames.size();
        const auto since = [](Clock::time_point then) {
            return std::chrono::duration<double>(Clock::now() - then).count();
        };
        EXPECT_TRUE(watch(
            {watcher.get()},
            [&] {
                if (watcher->frames.size() == seen) return false;
                waited.longest = std::max(waited.longest, since(last));
                seen = watcher->frames.size(), last = Clock::now();
                return wanted(difference(pictureOf(watcher->last()), *bare));
            },
            kCompiled));
        waited.all = since(begun);
        return waited;
    }
    static bool isSeen(double difference) { return difference > 3; }
    static bool isGone(double difference) { return difference < 1; }
    // The recorded session is stepped anew, without pictures: every recorded state must be the same.
    void expectTheRecordedTicks() {
        server->process().signal(SIGTERM);
        ASSERT_EQ(server->process().exitCode(), 0) << server->process().err();
        const auto replay = startServer({"--replay", recording.string()});
        EXPECT_EQ(replay->exitCode(), 0) << replay->err();
    }
};

// Pictures go on without the first light, and then with it. A second feature comes while the first one is compiled.
TEST_F(ListsOfAColdServer, PicturesGoOnUntilTheFirstLightAndTheFirstFogAreCompiled) {
    add(*watcher, "light", "light.range", 0);
    set(*watcher, "light[0].radius", 0.5);
    ASSERT_TRUE(
        watch({watcher.get()}, [&] { return watcher->lists.size() == kLists && !watcher->lists[kLights].empty(); }));
    EXPECT_FALSE(isSeen(difference(pictureOf(watcher->last()), *bare))) << "the simulation does not wait for shaders";
    add(*watcher, "fog", "fog.extinction", 0.3);
    const Waited both = watchUntil(isSeen);
    EXPECT_LT(both.longest, both.all / 3) << "of all " << both.all << " s";
    remove(*watcher, "fog[0]");
    remove(*watcher, "light[0]");
    const Waited back = watchUntil(isGone);
    EXPECT_LT(back.longest, both.all / 3);
    EXPECT_TRUE(watcher->errors.empty());
    RecordProperty("longest_ms", int(1000 * both.longest));
    RecordProperty("compiled_ms", int(1000 * both.all));
    expectTheRecordedTicks();
}

// The child process finds no scene. What it should have compiled is compiled where it is drawn, and the log says why.
TEST_F(ListsOfAColdServer, WithoutAChildThatCompilesTheFirstFogIsSeenAllTheSame) {
    std::filesystem::remove(scene);
    add(*watcher, "fog", "fog.extinction", 0.3);
    watchUntil(isSeen);
    EXPECT_NE(server->process().err().find("pictures may wait for them"), std::string::npos) << server->process().err();
    expectTheRecordedTicks();
}

} // namespace
} // namespace brume::test::lists_test

// Scenes that are switched, saved and loaded again while viewers look on.
#include <csignal>

#include "common/scene_text.h"
#include "tests/integration/scenes_fixture.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"
#include "tests/net/set_message.h"

namespace brume::test::scenes_test {
namespace {

const Pose kPose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);

TEST_F(Scenes, AnotherSceneIsShownToAllWithoutARestart) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds()});
    Watcher a(server.endpoint()), b(server.endpoint());
    EXPECT_EQ(a.session.granted().scene, "cloud");
    a.look(kPose);
    b.look(kPose);
    ASSERT_TRUE(watch({&a, &b}, [&] { return !a.frames.empty() && !b.frames.empty(); }));
    const HttpReply reply = post(server.port(), "/scene?name=tubes");
    EXPECT_EQ(reply.status, 200) << reply.body;
    EXPECT_EQ(reply.body, "scene 'tubes' is shown\n");
    const uint64_t tick = std::stoull(reply.headers.at("brume-tick"));
    // The first pictures of a scene are slow, and not all of one tick.
    ASSERT_TRUE(watch({&a, &b}, [&] {
        return a.last().tick > tick + 2 && b.last().tick > tick + 2 && !commonTicks(a, b, tick).empty();
    }));
    EXPECT_EQ(a.session.granted().scene, "tubes");
    EXPECT_EQ(b.session.granted().scene, "tubes");
    EXPECT_TRUE(a.errors.empty());
    for (const auto& [left, right] : commonTicks(a, b, tick)) EXPECT_EQ(left->state_hash, right->state_hash);
}

TEST_F(Scenes, WhatCannotBeShownLeavesTheOldSceneAndSaysWhy) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds()});
    const HttpReply none = post(server.port(), "/scene?name=../../etc/passwd");
    EXPECT_EQ(none.status, 422);
    EXPECT_NE(none.body.find("no scene of that name; there are: "), none.body.npos) << none.body;
    EXPECT_NE(none.body.find(" cloud, cloud-5000, "), none.body.npos) << none.body;
    EXPECT_EQ(post(server.port(), "/scene").status, 400);
    EXPECT_EQ(post(server.port(), "/cloud?name=a/b", points()).status, 400);
    EXPECT_EQ(post(server.port(), "/cloud", "").status, 400);
    EXPECT_EQ(get(server.port(), "/scene?name=tubes").status, 405);
    const HttpReply comma = post(server.port(), "/cloud?name=mine", points("0,5"));
    EXPECT_EQ(comma.status, 422);
    EXPECT_EQ(comma.body.find("mine.ply:10: "), 0u) << comma.body;
    EXPECT_NE(comma.body.find("is its comma a decimal point?"), comma.body.npos) << comma.body;
    const HttpReply taken = post(server.port(), "/cloud?name=plume", points());
    EXPECT_NE(taken.body.find("?name="), taken.body.npos) << taken.body;
    const Watcher a(server.endpoint());
    EXPECT_EQ(a.session.granted().scene, "cloud");
    EXPECT_FALSE(fs::exists(fs::path(clouds()) / "mine.ply"));
}

TEST_F(Scenes, TheSceneOfTheStartIsFoundAgain) {
    const fs::path own = write("own.toml", "[medium]\ncount = 100\n");
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds(), "--scene", own.string()});
    EXPECT_EQ(post(server.port(), "/scene?name=tubes").status, 200);
    const HttpReply back = post(server.port(), "/scene?name=own");
    EXPECT_EQ(back.status, 200) << back.body;
    EXPECT_EQ(metric(server.port(), "brume_particles"), 100);
    EXPECT_NE(post(server.port(), "/scene?name=none").body.find(", own"), std::string::npos);
    EXPECT_EQ(post(server.port(), "/cloud?name=own", points()).status, 422) << "its name is taken";
}

TEST_F(Scenes, WhatWasTunedIsSavedAndLoadsAsTheSame) {
    RunningServer server({"--ahead", "off"});
    Watcher a(server.endpoint());
    a.session.sendCommand<wire::Set>(test::set("medium.extinction", 7.25));
    HttpReply saved;
    ASSERT_TRUE(watch({&a}, [&] {
        saved = get(server.port(), "/scene.toml?position=1,2,30&target=0,1,0");
        return saved.body.find("extinction = 7.25\n") != saved.body.npos;
    })) << saved.body;
    EXPECT_EQ(saved.headers.at("content-disposition"), "attachment; filename=\"cloud.toml\"");
    const Scene scene = sceneOf(saved.body, "cloud.toml");
    EXPECT_EQ(scene.medium.extinction, 7.25f);
    EXPECT_EQ(scene.camera.position, glm::vec3(1, 2, 30));
    EXPECT_EQ(scene.medium.count, loadScene("server/scenes/cloud.toml").medium.count);
    EXPECT_EQ(scene.render.grid.spacing, kAuto);
}

TEST_F(Scenes, LightsOfEveryTypeAreSaved) {
    const fs::path file = write("spots.toml", "[[light]]\ntype = 'spot'\nrange = 7\n[[light]]\ntype = 'point'\n");
    RunningServer server({"--ahead", "off", "--scene", file.string()});
    const Scene dark = sceneOf(get(server.port(), "/scene.toml").body, "spots.toml");
    ASSERT_EQ(dark.lights.size(), 2u);
    EXPECT_EQ(dark.lights[0].type, kSpot);
    EXPECT_EQ(dark.lights[0].range, 7);
    Watcher a(server.endpoint());
    a.session.sendCommand<wire::Set>(test::set("light.irradiance", wire::Vec3(1, 2, 3)));
    Scene lit;
    ASSERT_TRUE(watch({&a}, [&] {
        lit = sceneOf(get(server.port(), "/scene.toml").body, "spots.toml");
        return lit.lights.size() == 3;
    }));
    EXPECT_EQ(lit.lights[0].type, kSpot);
    EXPECT_EQ(sunOf(lit).irradiance, glm::vec3(1, 2, 3));
}

TEST_F(Scenes, ASceneWhoseFileHasChangedIsLoadedAgainOnSighup) {
    const fs::path file = write("mine.toml", "[medium]\ncount = 100\n");
    RunningServer server({"--ahead", "off", "--scene", file.string()});
    Watcher a(server.endpoint());
    a.look(kPose);
    const auto particles = [&] { return metric(server.port(), "brume_particles"); };
    ASSERT_TRUE(watch({&a}, [&] { return particles() == 100; }));
    write("mine.toml", "[medium]\ncount = many\n");
    server.process().signal(SIGHUP);
    const auto logged = [&](const std::string& text) { return server.process().err().find(text) != std::string::npos; };
    ASSERT_TRUE(watch({&a}, [&] { return logged("reload: the scene stays: " + file.string() + ":2: "); }));
    EXPECT_EQ(particles(), 100);
    write("mine.toml", "[medium]\ncount = 200\n");
    server.process().signal(SIGHUP);
    ASSERT_TRUE(watch({&a}, [&] { return particles() == 200; })) << server.process().err();
    server.process().signal(SIGHUP);
    ASSERT_TRUE(watch({&a}, [&] { return logged("reload: the scene's files have not changed"); }));
}

// The recording of the first scene ends, and another begins; both replay.
TEST_F(Scenes, RecordingsGoOnInAFileForEachScene) {
    BRUME_WHOLE_LAYER_ONLY();
    const fs::path first = folder_ / "session.rec", second = folder_ / "session-2.rec";
    {
        RunningServer server({"--ahead", "off", "--record", first.string(), "--frames", "30"});
        Watcher a(server.endpoint());
        a.look(kPose);
        ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty() && a.last().tick > 70; }));
        const HttpReply reply = post(server.port(), "/scene?name=tubes");
        ASSERT_EQ(reply.status, 200);
        const uint64_t tick = std::stoull(reply.headers.at("brume-tick"));
        a.session.sendImpulse({{0, 0, 26}, {0, 0, -1}, {0, 0, 0}, 3});
        ASSERT_TRUE(watch({&a}, [&] { return a.last().tick > tick + 70; }));
        server.process().signal(SIGTERM);
        EXPECT_EQ(server.process().exitCode(), 0);
    }
    const auto ended = startServer({"--replay", first.string(), "--frames", "30"});
    EXPECT_EQ(ended->exitCode(), 0) << ended->err();
    EXPECT_NE(ended->out().find("the recording ended: another scene is shown"), std::string::npos) << ended->out();
    const auto on = startServer({"--replay", second.string(), "--frames", "30"});
    EXPECT_EQ(on->exitCode(), 0) << on->err();
    EXPECT_NE(on->out().find("with 1 commands"), std::string::npos) << on->out();
    EXPECT_NE(on->out().find("scene 'tubes'"), std::string::npos) << on->out();
}

} // namespace
} // namespace brume::test::scenes_test

// Layout `sequence`: numbered files of a simulation that was computed before.
#include "server/sim/sequence.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/sim/point_cloud.h"
#include "tests/unit/allocations.h"
#include "tests/unit/sequences.h"

namespace brume::sequences_test {
namespace {

// As a file alone does, and the same in all of its files: more points are more smoke.
TEST_F(Sequences, PointsWithoutAnExtinctionHaveThatOfTheFirstFile) {
    put("smoke-001.ply", kXyz, "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
    put("smoke-002.ply", kXyz, "0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 2\n0 2 0\n2 0 0\n1 1 1\n");
    Simulation simulation(scene());
    std::ofstream(folder / "alone.toml") << "[medium]\nlayout = 'file'\nfile = 'smoke-001.ply'\n";
    const float alone = particlesOf(Simulation(loadScene(folder / "alone.toml"))).front().sigma_t;
    EXPECT_GT(alone, 0.1f);
    for (const gpu::Particle& p : particlesOf(simulation)) EXPECT_EQ(p.sigma_t, alone);
    run(simulation, 6);
    ASSERT_EQ(particlesOf(simulation).size(), 8u);
    for (const gpu::Particle& p : particlesOf(simulation)) EXPECT_EQ(p.sigma_t, alone);
    give(simulation, {command(Set{{"medium.extinction", 2 * simulation.now().medium.extinction}})});
    EXPECT_FLOAT_EQ(particlesOf(simulation).front().sigma_t, 2 * alone);
}

// Smoke has not begun, and ends.
TEST_F(Sequences, FilesWithoutPointsAreMomentsWithoutAny) {
    put("smoke-001.ply", kXyz, "");
    put("smoke-002.ply", kXyz, "0 0 0\n1 0 0\n");
    put("smoke-003.ply", kXyz, "");
    const Scene played = scene();
    Simulation simulation(played);
    EXPECT_EQ(simulation.liveCount(), 0u);
    EXPECT_NE(pointCloudLine(played, simulation).find("0 to 2 points"), std::string::npos);
    EXPECT_TRUE(pointCloudWarnings(played, simulation).empty());
    run(simulation, 6);
    EXPECT_EQ(xs(simulation), (Floats{0, 1}));
    run(simulation, 6);
    EXPECT_EQ(simulation.liveCount(), 0u);
    EXPECT_EQ(standIn(played).medium.file.filename(), "smoke-002.ply");
    put("smoke-002.ply", kXyz, "");
    EXPECT_THROW(Simulation{scene()}, SceneError);
}

// Six steps from file to file. Point 7 is in all, 5 in the first only, 9 from the second on; rows are in no order.
TEST_F(Sequences, PointsWithIdsMoveEvenlyAndOthersComeAndGoWithTheirFiles) {
    put("smoke-004.ply", kOwn, "0 0 0 7 1 2 1 0 0.5\n50 0 0 5 1 2 1 1 1\n");
    put("smoke-005.ply", kOwn, "90 0 0 9 3 4 0 0 0\n6 12 -3 7 4 5 0 1 0.5\n");
    put("smoke-006.ply", kOwn, "0 0 0 7 1 2 1 0 0.5\n90 0 0 9 3 4 0 0 0\n");
    const Scene played = scene();
    Simulation simulation(played);
    EXPECT_EQ(simulation.capacity(), 2u);
    EXPECT_EQ(xs(simulation), (Floats{50, 0})) << "by their ids: 5, 7";
    for (int step = 1; step < 6; ++step) {
        simulation.step({});
        const float part = float(step) / 6;
        const auto now = particlesOf(simulation);
        EXPECT_EQ(now[0].centre, glm::vec3(50, 0, 0));
        EXPECT_NEAR(now[1].centre.x, 6 * part, 1e-5f);
        EXPECT_NEAR(now[1].centre.y, 12 * part, 1e-5f);
        EXPECT_NEAR(now[1].centre.z, -3 * part, 1e-5f);
        EXPECT_NEAR(now[1].scale, 1 + 3 * part, 1e-5f);
        EXPECT_NEAR(now[1].sigma_t, 2 + 3 * part, 1e-5f);
        EXPECT_NEAR(now[1].albedo.x, 1 - part, 1e-5f);
        EXPECT_NEAR(now[1].albedo.y, part, 1e-5f);
    }
    simulation.step({});
    EXPECT_EQ(xs(simulation), (Floats{6, 90})) << "the second file itself";
    EXPECT_EQ(particlesOf(simulation)[0].sigma_t, 5);
    run(simulation, 3);
    EXPECT_EQ(xs(simulation), (Floats{3, 90}));
    run(simulation, 3);
    EXPECT_EQ(xs(simulation), (Floats{0, 90}));
    run(simulation, 5);
    EXPECT_EQ(xs(simulation), (Floats{0, 90})) << "the last file stands as long as the others";
    simulation.step({});
    EXPECT_EQ(xs(simulation), (Floats{50, 0})) << "and then comes the first again";
    EXPECT_NE(lines(played).find("3 files, 4 to 6, in 0.3 s, again and again; 2 points; they move by their ids; the "
                                 "first file: 2 points in [0, 0, 0] to [50, 0, 0] m; scale 1 m (the file's scale)"),
              std::string::npos)
        << lines(played);
}

TEST_F(Sequences, WithoutIdsEachFileIsShownUntilTheNextAndTheLastStays) {
    put("smoke-000.ply", kIds, "0 0 0 1\n");
    put("smoke-001.ply", kXyz, "1 0 0\n2 0 0\n3 0 0\n");
    put("smoke-002.ply", kXyz + "float id\n", "4 0 0 1\n");
    put("smoke-0003.ply", kXyz, "9 0 0\n"); // other names
    put("smoke-x03.ply", kXyz, "9 0 0\n");
    put("Smoke-003.ply", kXyz, "9 0 0\n");
    const Scene played = scene("rate = 10\nloop = false\n");
    Simulation simulation(played);
    EXPECT_EQ(simulation.capacity(), 3u);
    for (int step = 0; step < 30; ++step) {
        EXPECT_EQ(xs(simulation), step < 6 ? Floats{0} : step < 12 ? (Floats{1, 2, 3}) : Floats{4}) << step;
        simulation.step({});
    }
    EXPECT_NE(lines(played).find("once; 1 to 3 points; each file is shown until the next, as 'smoke-001.ply' has no "
                                 "property id of whole numbers"),
              std::string::npos)
        << lines(played);
}

TEST_F(Sequences, ANumberIsATimeAndMissingOnesAreTold) {
    put("smoke-010.ply", kIds, "0 0 0 1\n");
    put("smoke-011.ply", kIds, "1 0 0 1\n");
    put("smoke-014.ply", kIds, "7 0 0 1\n");
    const Scene played = scene();
    Simulation simulation(played);
    run(simulation, 6);
    EXPECT_EQ(xs(simulation), Floats{1});
    run(simulation, 6);
    EXPECT_NEAR(xs(simulation)[0], 3, 1e-5f) << "a third of the longer way";
    run(simulation, 12);
    EXPECT_EQ(xs(simulation), Floats{7});
    EXPECT_NE(lines(played).find("2 numbers between 10 and 14 have no file, the first is 12: the file before each "
                                 "lasts longer"),
              std::string::npos)
        << lines(played);
}

TEST_F(Sequences, PausesRestartsAndFollowsTheVolumeButNoPush) {
    put("smoke-000.ply", kIds, "0 0 0 1\n5 0 0 2\n");
    put("smoke-001.ply", kIds, "6 0 0 1\n");
    Simulation simulation(scene()), calm(scene());
    const uint64_t start = simulation.stateHash();
    run(simulation, 3);
    give(simulation, {command(Set{{"simulation.paused", true}})});
    run(simulation, 5);
    EXPECT_EQ(xs(simulation), (Floats{3, 5}));
    give(simulation, {command(Set{{"simulation.paused", false}}), command(MoveVolume{.offset = {0, 0, 2}})});
    EXPECT_EQ(particlesOf(simulation)[0].centre, glm::vec3(4, 0, 2));
    run(simulation, 3);
    EXPECT_EQ(xs(simulation).size(), 1u);
    give(simulation, {command(Restart{}), command(Set{{"simulation.paused", true}})});
    EXPECT_EQ(xs(simulation), (Floats{0, 5}));
    give(simulation, {command(Restart{})});
    calm.step({});
    EXPECT_EQ(simulation.stateHash(), calm.stateHash());
    EXPECT_NE(simulation.stateHash(), start);
    give(simulation, {command(Impulse{.origin = {1, 0, 9}})});
    calm.step({});
    EXPECT_EQ(simulation.stateHash(), calm.stateHash());
}

TEST_F(Sequences, EqualFilesGiveEqualHashesAndAnyDifferenceAnother) {
    const auto with = [&](const std::string& second, const std::string& medium = "rate = 10\n") {
        put("smoke-000.ply", kOwn, "0 0 0 7 1 2 1 0 0.5\n");
        put("smoke-001.ply", kOwn, second);
        return scene(medium);
    };
    const std::string second = "1 0 0 7 1 2 1 0 0.5\n";
    Simulation a(with(second)), b(with(second));
    for (int step = 0; step < 20; ++step) {
        ASSERT_EQ(a.stateHash(), b.stateHash()) << step;
        a.step({});
        b.step({});
    }
    const uint64_t start = Simulation(with(second)).stateHash();
    for (const char* other : {"2 0 0 7 1 2 1 0 0.5\n", "1 0 0 8 1 2 1 0 0.5\n", "1 0 0 7 2 2 1 0 0.5\n",
                              "1 0 0 7 1 3 1 0 0.5\n", "1 0 0 7 1 2 1 0 0.25\n"})
        EXPECT_NE(Simulation(with(other)).stateHash(), start) << other;
    EXPECT_NE(Simulation(with(second, "rate = 20\n")).stateHash(), start);
    EXPECT_NE(Simulation(with(second, "rate = 10\nloop = false\n")).stateHash(), start);
}

// A particle's own numbers of the scene's ranges go with its id, not with its row.
TEST_F(Sequences, SizesAndFactorsOfTheSceneBelongToThePoint) {
    put("smoke-000.ply", kIds, "0 0 0 7\n1 0 0 8\n");
    put("smoke-001.ply", kIds, "2 0 0 8\n");
    Simulation simulation(scene("rate = 10\nscale = [1, 2]\nmultiplier = [1, 1000]\nextinction = 100\n"));
    const auto before = particlesOf(simulation);
    EXPECT_NE(before[0].scale, before[1].scale);
    run(simulation, 6);
    const auto after = particlesOf(simulation);
    ASSERT_EQ(after.size(), 1u);
    EXPECT_EQ(after[0].scale, before[1].scale);
    EXPECT_EQ(after[0].sigma_t, before[1].sigma_t);
    give(simulation, {command(Set{{"medium.extinction", 50.0f}})});
    EXPECT_EQ(particlesOf(simulation)[0].sigma_t, 0.5f * before[1].sigma_t);
}

TEST_F(Sequences, SizesFromTheSpacingAreThoseOfTheFirstFile) {
    std::string lattice, wider;
    for (int i = 0; i < 125; ++i) {
        const int x = i % 5, y = i / 5 % 5, z = i / 25;
        lattice += fmt::format("{} {} {}\n", x, y, z);
        wider += fmt::format("{} {} {}\n", 3 * x, 3 * y, 3 * z);
    }
    put("smoke-000.ply", kXyz, lattice);
    put("smoke-001.ply", kXyz, wider);
    const Scene played = scene();
    Simulation simulation(played);
    const float scale = particlesOf(simulation)[0].scale;
    run(simulation, 6);
    EXPECT_EQ(particlesOf(simulation)[0].scale, scale);
    EXPECT_LT(scale, 6) << "from the spacing, not the default";
    EXPECT_NE(lines(played).find("from the spacing of the points"), std::string::npos) << lines(played);
}

TEST_F(Sequences, SlidersAreFactorsOfTheirOwnValues) {
    put("smoke-000.ply", kOwn, "0 0 0 7 1 2 1 0 0.5\n");
    Simulation simulation(scene("extinction = 10\nalbedo = [0.5, 0.5, 0.5]\n"));
    EXPECT_EQ(particlesOf(simulation)[0].sigma_t, 2);
    give(simulation, {command(Set{{"medium.extinction", 20.0f}, {"medium.albedo", glm::vec3(0.25f)}})});
    EXPECT_EQ(particlesOf(simulation)[0].sigma_t, 4);
    EXPECT_EQ(particlesOf(simulation)[0].albedo, glm::vec3(0.5f, 0, 0.25f));
}

TEST_F(Sequences, StepAllocatesNothing) {
    put("smoke-000.ply", kOwn, "0 0 0 7 1 2 1 0 0.5\n3 0 0 8 1 2 1 0 0.5\n");
    put("smoke-001.ply", kOwn, "1 0 0 7 1 2 1 0 0.5\n");
    put("smoke-002.ply", kOwn, "1 0 0 7 1 2 1 0 0.5\n4 0 0 9 1 2 1 0 0.5\n5 0 0 10 1 2 1 0 0.5\n");
    Simulation simulation(scene());
    const std::vector<Command> restart{command(Restart{})}, none;
    const size_t before = allocations();
    for (int step = 0; step < 40; ++step) simulation.step(step == 30 ? restart : none);
    EXPECT_EQ(allocations(), before);
}

TEST_F(Sequences, BadFilesEndInOneLineThatNamesThem) {
    EXPECT_NE(errorOf().find("smoke-###.ply: no such file; expected numbered files"), std::string::npos) << errorOf();
    put("smoke-000.ply", kIds, "0 0 0 7\n");
    put("smoke-001.ply", kIds, "0 0 x 7\n");
    EXPECT_NE(errorOf().find("smoke-001.ply:9: PLY: property z: \"x\" is not a number"), std::string::npos)
        << errorOf();
    put("smoke-001.ply", kIds, "0 0 0 7\n1 0 0 8\n2 0 0 7\n");
    EXPECT_NE(errorOf().find("smoke-001.ply: PLY: property id: points 1 and 3 are both number 7"), std::string::npos)
        << errorOf();
    put("smoke-001.ply", kIds + "float scale\n", "0 0 0 7 1\n");
    const std::string unlike = errorOf("extinction = 5\n");
    EXPECT_NE(unlike.find("smoke-001.ply: PLY: the file's scale, medium.extinction, medium.multiplier, no colours, no "
                          "velocities; the first file of the sequence has: no sizes"),
              std::string::npos)
        << unlike;
    put("smoke-001.ply", kIds, "0 0 0 7\n1 0 0 0.5\n2 0 99999 8\n");
    EXPECT_NE(lines(scene()).find("dropped 2 of 4 points; the first, smoke-001.ply, line 10: id is 0.5; allowed: "
                                  "-2147483648 to 4294967295, whole numbers"),
              std::string::npos)
        << lines(scene());
    std::string many;
    for (int i = 0; i < 20'000; ++i) many += "0 0 0 " + std::to_string(i) + '\n';
    for (const char* name : {"smoke-001.ply", "smoke-002.ply"}) put(name, kIds, many);
    EXPECT_NE(errorOf().find("the first 3 of 3 files hold 1 MiB of points, --memory allows 1: use fewer files"),
              std::string::npos)
        << errorOf();
}

TEST_F(Sequences, TheSceneSaysWhatTheNamesAre) {
    const auto refused = [&](const std::string& medium) {
        std::ofstream(folder / "scene.toml") << "[medium]\n" << medium;
        try {
            loadScene(folder / "scene.toml");
        } catch (const SceneError& error) {
            return std::string(error.what()).substr((folder / "scene.toml").string().size());
        }
        return std::string("no error");
    };
    EXPECT_EQ(refused("layout = 'sequence'\n").find(":2: medium.layout: \"sequence\" without files"), 0u);
    for (const char* wrong : {"smoke.ply", "smoke-#-#.ply", "smoke-##########.ply", "a###/smoke.ply"})
        EXPECT_NE(refused(std::string("layout = 'sequence'\nfile = '") + wrong + "'\n").find("a run of 1 to 9 #"),
                  std::string::npos)
            << wrong;
    EXPECT_EQ(refused("layout = 'cube'\nrate = 5\n").find(":3: medium.rate: not used by this layout"), 0u);
    EXPECT_EQ(refused("layout = 'live'\nloop = true\n").find(":3: medium.loop: not used by this layout"), 0u);
    EXPECT_EQ(refused("layout = 'sequence'\nfile = 'a#.ply'\ncount = 5\n").find(":4: medium.count: not used"), 0u);
    EXPECT_EQ(refused("layout = 'sequence'\nfile = 'a#.ply'\nrate = 0\n").find(":4: medium.rate: 0 is not allowed"),
              0u);
}

TEST_F(Sequences, OfAllFilesTheFirstStandsIn) {
    put("smoke-003.ply", kIds, "0 0 0 7\n");
    put("smoke-001.ply", kIds, "0 0 0 7\n1 1 1 8\n");
    const Scene one = standIn(scene());
    EXPECT_EQ(one.medium.layout, Layout::file);
    EXPECT_EQ(Simulation(one).capacity(), 2u);
    EXPECT_EQ(standIn(plumeScene()).medium.layout, Layout::emitter);
    Scene live = cubeScene(9);
    live.medium.layout = Layout::live;
    EXPECT_EQ(Simulation(standIn(live)).liveCount(), 9u);
}

} // namespace
} // namespace brume::sequences_test

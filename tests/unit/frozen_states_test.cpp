// Frozen hashes of states: the same with GCC and Clang, with every libm, with and without AVX2, in every build type.
// Another hash breaks replays: change one on purpose only. Hashes of objects that a scene lays out, likewise.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "common/object_layout.h"
#include "server/sim/simulation.h"
#include "server/sim/state_hash.h"

namespace brume {
namespace {

// In an own folder, which begins empty.
class FrozenStates : public testing::Test {
protected:
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("brume-frozen-" + std::to_string(getpid()));

    void SetUp() override { std::filesystem::create_directories(folder); }
    void TearDown() override { std::filesystem::remove_all(folder); }

    void put(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }
    // Points of two numbers besides their places.
    void putPoints(const std::string& name, const std::string& first, const std::string& second,
                   const std::string& points) const {
        put(name, "ply\nformat ascii 1.0\nelement vertex " +
                      std::to_string(std::count(points.begin(), points.end(), '\n')) +
                      "\nproperty float x\nproperty float y\nproperty float z\nproperty " + first + "\nproperty " +
                      second + "\nend_header\n" + points);
    }
    // The state of a scene with that table [medium] after 90 ticks.
    uint64_t hashOf(const std::string& medium) const {
        put("scene.toml", "[[light]]\nto_light = [1, 2, 3]\nrotate = 0.3\n[[light]]\ntype = 'spot'\norbit = 1\n"
                          "[[fog]]\nextinction = 0.02\n[[box]]\n[medium]\n" +
                              medium);
        return stateOf(loadScene(folder / "scene.toml"));
    }
    static uint64_t stateOf(const Scene& scene) {
        Simulation simulation(scene);
        for (int tick = 1; tick <= 90; ++tick) simulation.step(commandsAt(tick, scene.medium.layout));
        return simulation.stateHash();
    }

    static std::vector<Command> commandsAt(int tick, Layout layout) {
        std::vector<CommandBody> bodies;
        if (layout == Layout::live && tick % 20 == 1)
            bodies.emplace_back(SetParticles{uint32_t(tick % 3), 4, 0.1f,
                                             std::make_shared<const ParticleRows>(ParticleRows{
                                                 {{0.1f, float(tick), 2}, {3, -0.7f, 0}}, {1, 2.5f}, {0.3f, 2}, {}})});
        if (tick == 3) bodies.emplace_back(Impulse{.origin = {0.3f, 1, 20}, .direction = {0, -1, -9}, .strength = 3});
        if (tick == 10) bodies.emplace_back(MoveVolume{{1, 2.1f, -1}});
        if (tick == 20)
            bodies.emplace_back(Set{{"light.irradiance", glm::vec3(3, 2, 1)},
                                    {"medium.extinction", 40.3f},
                                    {"medium.phase", "rayleigh"},
                                    {"render.isv.steps", 4u}});
        if (tick == 30 && layout != Layout::none) bodies.emplace_back(Add{SceneList::boxes, {}});
        if (tick == 40) bodies.emplace_back(Set{{"simulation.paused", true}});
        if (tick == 45) bodies.emplace_back(Set{{"simulation.paused", false}, {"box[0].yaw", 0.3f}});
        if (tick == 60) bodies.emplace_back(Impulse{.origin = {0, 1, 20}, .push = {3, 0, 0}, .strength = -2});
        std::vector<Command> commands;
        for (CommandBody& body : bodies) commands.push_back({1, uint32_t(tick), std::move(body)});
        return commands;
    }
};

TEST_F(FrozenStates, OfLayoutsWithoutFiles) {
    EXPECT_EQ(hashOf("layout = 'cube'\ncount = 1000\nscale = [0.5, 2]\nmultiplier = [1, 3]"), 0xa5c39b6709c3558eu);
    EXPECT_EQ(hashOf("layout = 'tubes'\ncount = 1000\nscale = [0.5, 2]\nseed = 7"), 0x62b94113d210088au);
    EXPECT_EQ(hashOf("layout = 'cumulus'\ncount = 1000\nscale = [0.5, 3]"), 0x49e9b178cdf01e00u);
    EXPECT_EQ(hashOf("layout = 'live'\ncount = 8\nextinction = 10"), 0xa9135cca475cab63u);
    EXPECT_EQ(hashOf("layout = 'none'"), 0x28725f97cb6edd0du);
    EXPECT_EQ(hashOf("layout = 'emitter'\ncount = 1000\nemitter = { rate = 300, life = 3, turbulence = 0.7 }"),
              0x68a8c3d6b067017cu);
}

TEST_F(FrozenStates, OfPointsFromFiles) {
    putPoints("opacity.ply", "float scale", "float opacity",
              "0.1 0.2 0.3 1 0.001\n5 0 0 2 0.3\n1 2 3 1.5 0.75\n0 0 1 3 0.9999\n2 0 1 3 0.47213596\n");
    putPoints("bare.ply", "float nx", "float ny", "0.1 0.2 0.3 0 0\n5 0 0 0 0\n1 2 3 0 0\n0 1 1 0 0\n");
    putPoints("radius.ply", "float radius", "float sigma_t", "0.1 0.2 0.3 0.3 2\n5 0 0 1.7 0.3\n");
    EXPECT_EQ(hashOf("layout = 'file'\nfile = 'opacity.ply'\nfalloff = 1.3"), 0x0d77177a0e124387u);
    EXPECT_EQ(hashOf("layout = 'file'\nfile = 'bare.ply'"), 0x62f49f6a06fad562u);
    EXPECT_EQ(hashOf("layout = 'file'\nfile = 'radius.ply'"), 0x02ea78c0126aeaf9u);
}

TEST_F(FrozenStates, OfSequences) {
    putPoints("smoke-000.ply", "int id", "float opacity", "0.1 0.2 0.3 1 0.2\n5 0 0 2 0.7\n");
    putPoints("smoke-001.ply", "int id", "float opacity", "6 0.7 0 1 0.3\n1 1 1 3 0.11\n");
    EXPECT_EQ(hashOf("layout = 'sequence'\nfile = 'smoke-###.ply'\nrate = 7\nscale = [1, 2]\nseed = 3"),
              0x513e8ca2f64c277fu);
}

TEST_F(FrozenStates, OfUnions) {
    put("scene.toml", "[medium]\nmodel = 'union'\ncount = 200\nunion_radius = 0.3\n");
    EXPECT_EQ(stateOf(loadScene(folder / "scene.toml")), 0xf76b7235f71d8283u);
}

TEST_F(FrozenStates, OfTetrahedra) {
    put("cells.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
                     "property float sigma_t\nelement tetrahedron 2\nproperty list uchar int vertex_indices\n"
                     "end_header\n0 0 0 0\n1 0 0 0.5\n0 1 0.1 0\n0 0.2 1.3 2\n1 1 1 0\n4 0 1 2 3\n4 1 2 3 4\n");
    put("scene.toml", "[medium]\nmodel = 'tetrahedra'\nlayout = 'file'\nfile = 'cells.ply'\n");
    EXPECT_EQ(stateOf(loadScene(folder / "scene.toml")), 0x1c35256634be87edu);
}

TEST(FrozenObjects, AreThoseOfTheirSeed) {
    const auto hashOf = [](const std::string& layout) {
        StateHash hash;
        const LaidOut out = layOut({.layout = layout, .count = 1500});
        for (const Box& box : out.boxes)
            for (const float value : {box.centre.x, box.centre.y, box.centre.z, box.size.x, box.size.y, box.size.z,
                                      box.yaw, box.albedo.x, box.albedo.y, box.albedo.z})
                hash.add(std::span(&value, 1));
        for (const Sphere& sphere : out.spheres)
            for (const float value : {sphere.centre.x, sphere.centre.y, sphere.centre.z, sphere.radius, sphere.albedo.x,
                                      sphere.albedo.y, sphere.albedo.z})
                hash.add(std::span(&value, 1));
        return hash.value();
    };
    EXPECT_EQ(hashOf(kCourtyard), 0x90a0813898d42c2au);
    EXPECT_EQ(hashOf(kStreet), 0x31c6d07a315af031u);
    EXPECT_EQ(hashOf(kIslands), 0x1594fb0b08a83692u);
    EXPECT_EQ(hashOf(kAtrium), 0x459f08ee7182b508u);
}

} // namespace
} // namespace brume

// A state that is saved and loaded goes on as the one that it was, whatever moves its particles.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/unit/simulation_scenes.h"

namespace brume {
namespace {

Scene sceneOf(Layout layout) {
    Scene scene = layout == Layout::emitter ? plumeScene() : cubeScene(200);
    scene.medium.layout = layout;
    scene.fogs.push_back({});
    scene.boxes.push_back({});
    scene.lights.push_back({.type = kPoint, .orbit = 1, .pivot = {3, 0, 0}});
    return scene;
}

// A sequence of two files with ids and albedos, and points of a file with albedos.
Scene sceneOfFile(const std::filesystem::path& folder, const std::string& medium) {
    std::filesystem::create_directories(folder);
    for (const int number : {1, 2})
        std::ofstream(folder / ("p-" + std::to_string(number) + ".ply"))
            << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
               "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int id\nend_header\n"
            << number << " 0 0 250 20 30 1\n0 " << number << " 0 9 200 3 2\n5 5 " << number << " 4 50 60 3\n";
    std::ofstream(folder / "scene.toml") << "[medium]\n" << medium;
    return loadScene(folder / "scene.toml");
}

SetParticles rows(float x, float seconds) {
    ParticleRows some;
    for (int i = 0; i < 20; ++i) some.positions.emplace_back(x, float(i), 0);
    some.scales.assign(20, 2);
    some.extinctions.assign(20, 0.5f);
    some.albedos.assign(20, glm::vec3(0.25f, 0.5f, 0.75f));
    return {.first = 0, .live = 15, .seconds = seconds, .rows = std::make_shared<const ParticleRows>(std::move(some))};
}

// What two simulations are asked for alike.
std::vector<Command> commandsAt(uint64_t tick) {
    switch (tick % 50) {
    case 3:
        return {command(Impulse{.origin = {0, 0, 20}}), command(rows(float(tick) * 0.1f, 0.5f))};
    case 7:
        return {command(Set{{"medium.extinction", 3.0f}, {"render.exposure", 1.5f}, {"fog[0].height", 2.0f}})};
    case 11:
        return {command(Add{SceneList::fogs, {}}), command(Add{SceneList::lights, {}}),
                command(Add{SceneList::spheres, {}})};
    case 23:
        return {command(Remove{SceneList::fogs, 0}), command(MoveVolume{{0.25f, 0, -1}})};
    case 31:
        return {command(Set{{"simulation.paused", tick % 100 < 50}, {"render.method", std::string("slabs")}})};
    case 33:
        return {command(MoveVolume{{0, 1, 0}})};
    case 37:
    case 38:
        return {command(Undo{tick % 50 == 38})};
    case 45:
        if (tick > 150) return {command(Restart{})};
        return {command(Set{{"light.rotate", 1.0f}})};
    default:
        return {};
    }
}

void run(Simulation& simulation, uint64_t until) {
    while (simulation.tick() < until) simulation.step(commandsAt(simulation.tick() + 1));
}

void expectEqual(const Simulation& a, const Simulation& b) {
    ASSERT_EQ(a.tick(), b.tick());
    ASSERT_EQ(a.stateHash(), b.stateHash()) << "at tick " << a.tick();
    ASSERT_EQ(a.listsHash(), b.listsHash());
    ASSERT_EQ(a.bounds().lo, b.bounds().lo);
    ASSERT_EQ(a.bounds().max_sigma_t, b.bounds().max_sigma_t);
    const auto ours = particlesOf(a), theirs = particlesOf(b);
    ASSERT_EQ(ours.size(), theirs.size());
    if (ours.empty()) return;
    ASSERT_EQ(0, std::memcmp(ours.data(), theirs.data(), ours.size() * sizeof ours[0])) << "at tick " << a.tick();
}

void expectGoesOn(const Scene& scene) {
    std::vector<std::byte> bytes, again;
    for (const uint64_t saved_at : {uint64_t{0}, uint64_t{5}, uint64_t{34}, uint64_t{120}, uint64_t{246}}) {
        Simulation first(scene);
        run(first, saved_at);
        first.save(bytes);
        Simulation second(scene);
        run(second, 13); // of which nothing is left
        second.load(bytes);
        expectEqual(first, second);
        second.save(again);
        EXPECT_EQ(bytes, again);
        for (uint64_t until = saved_at + 1; until < saved_at + 150; until += 7) {
            run(first, until);
            run(second, until);
            expectEqual(first, second);
        }
    }
}

class SavedState : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(All, SavedState, testing::Values(Layout::cube, Layout::emitter, Layout::live, Layout::none));

TEST_P(SavedState, GoesOnToTheSameBits) { expectGoesOn(sceneOf(GetParam())); }

TEST(SavedState, GoesOnWithParticlesOfFiles) {
    const auto folder = std::filesystem::temp_directory_path() / ("brume-state-" + std::to_string(getpid()));
    expectGoesOn(sceneOfFile(folder, "layout = 'sequence'\nfile = 'p-#.ply'\nrate = 1.5\nloop = true\n"));
    expectGoesOn(sceneOfFile(folder, "layout = 'file'\nfile = 'p-1.ply'\n"));
    std::filesystem::remove_all(folder);
}

TEST(SavedState, OfAnotherSceneIsRefused) {
    std::vector<std::byte> bytes;
    Simulation(cubeScene(100)).save(bytes);
    Simulation other(cubeScene(100, 2)), more(cubeScene(101));
    EXPECT_THROW(other.load(bytes), StateError);
    EXPECT_THROW(more.load(bytes), StateError);
}

TEST(SavedState, CutOrLongerIsRefused) {
    const Scene scene = sceneOf(Layout::emitter);
    std::vector<std::byte> bytes;
    Simulation simulation(scene);
    run(simulation, 60);
    simulation.save(bytes);
    Simulation other(scene);
    for (size_t size = 0; size < bytes.size(); size += size < 2000 ? 1 : 977)
        ASSERT_THROW(other.load(std::span(bytes).first(size)), StateError) << size;
    bytes.push_back({});
    EXPECT_THROW(other.load(bytes), StateError);
}

// A changed byte is either seen or of a column that the hash leaves out; nothing breaks by it.
TEST(SavedState, ChangedBytesBreakNothing) {
    const Scene scene = sceneOf(Layout::live);
    std::vector<std::byte> bytes;
    Simulation simulation(scene);
    run(simulation, 60);
    simulation.save(bytes);
    size_t seen = 0, tried = 0;
    for (size_t at = 0; at < bytes.size(); at += 3, ++tried) {
        Simulation other(scene);
        bytes[at] ^= std::byte{0x55};
        try {
            other.load(bytes);
            other.step({});
        } catch (const StateError&) {
            ++seen;
        }
        bytes[at] ^= std::byte{0x55};
    }
    EXPECT_GT(seen, 0u);
    EXPECT_GT(tried, 1000u);
}

TEST(SavedState, LeavesOutColumnsThatAreAsAtTheStart) {
    std::vector<std::byte> bytes;
    Simulation simulation(cubeScene(10'000));
    run(simulation, 10);
    simulation.save(bytes);
    EXPECT_LT(bytes.size(), 6 * sizeof(float) * 10'000 + 4096); // places and velocities, no homes
}

} // namespace
} // namespace brume

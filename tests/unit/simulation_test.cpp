// The shared simulation: the same commands give the same bits, and what it does to particles is what its comments say.
#include "server/sim/simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/allocations.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::simulation_test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

Scene sceneOf(Layout layout) { return layout == Layout::emitter ? plumeScene() : cubeScene(); }

void run(Simulation& simulation, int ticks) {
    for (int i = 0; i < ticks; ++i) simulation.step({});
}

glm::vec3 meanOf(const std::vector<gpu::Particle>& particles) {
    glm::dvec3 sum{0};
    for (const gpu::Particle& p : particles) sum += glm::dvec3(p.centre);
    return sum / static_cast<double>(particles.size());
}

// One of each command, at fixed ticks.
std::vector<uint64_t> hashesOf(Simulation& simulation) {
    const std::vector<std::pair<int, Command>> script{
        {3, command(Impulse{.origin = {0, 1, 20}})},
        {10, command(MoveVolume{.offset = {1, 2, -1}})},
        {20, command(Set{{"light.to_light", glm::vec3(1, 2, 3)}, {"light.rotate", 0.7f}})},
        {30, command(Set{{"medium.extinction", 40.0f}, {"medium.falloff", 1.4f}, {"medium.asymmetry", 0.3f}})},
        {40, command(Set{{"render.method", "isv"}, {"render.isv.steps", 4u}, {"render.exposure", 1.5f}})},
        {50, command(Set{{"simulation.paused", true}})},
        {55, command(Set{{"simulation.paused", false}})},
        {60, command(Impulse{.origin = {0, 1, 20}, .push = {3, 0, 0}, .strength = -2})},
    };
    std::vector<uint64_t> hashes;
    std::vector<Command> now;
    for (int tick = 0; tick < 120; ++tick) {
        now.clear();
        for (const auto& [at, c] : script)
            if (at == tick) now.push_back(c);
        simulation.step(now);
        hashes.push_back(simulation.stateHash());
    }
    return hashes;
}

class AnyLayout : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(All, AnyLayout, testing::Values(Layout::cube, Layout::emitter),
                         [](const auto& layout) { return layout.param == Layout::emitter ? "emitter" : "cube"; });

TEST_P(AnyLayout, EqualSeedsAndCommandsGiveEqualHashes) {
    Simulation a(sceneOf(GetParam())), b(sceneOf(GetParam()));
    EXPECT_EQ(a.stateHash(), b.stateHash());
    EXPECT_EQ(hashesOf(a), hashesOf(b));
}

TEST_P(AnyLayout, AnotherSeedIsAnotherState) {
    Scene scene = sceneOf(GetParam());
    const Simulation a(scene);
    scene.medium.seed = 2;
    EXPECT_NE(a.stateHash(), Simulation(scene).stateHash());
}

TEST(Hash, DirectionsCountAndNotTheirLengths) {
    Simulation a(cubeScene()), b(cubeScene());
    give(a, {command(Impulse{.origin = {0, 0, 20}}), command(Set{{"light.to_light", glm::vec3(0, 1, 0)}})});
    give(b, {command(Impulse{.origin = {0, 0, 20}, .direction = {0, 0, -40'000}}),
             command(Set{{"light.to_light", glm::vec3(0, 1e-5f, 0)}})});
    EXPECT_EQ(a.stateHash(), b.stateHash());
}

TEST(Hash, OrderOfCommandsMatters) {
    const Command thin = command(Set{{"medium.extinction", 5.0f}});
    const Command thick = command(Set{{"medium.extinction", 50.0f}});
    Simulation a(cubeScene()), b(cubeScene());
    give(a, {thin, thick});
    give(b, {thick, thin});
    EXPECT_EQ(a.now().medium.extinction, 50);
    EXPECT_EQ(b.now().medium.extinction, 5);
    EXPECT_NE(a.stateHash(), b.stateHash());
}

TEST(Hash, SeesEveryParameterThatACommandCanChange) {
    const std::vector<Command> changes{
        command(Impulse{.origin = {0, 0, 20}}),
        command(MoveVolume{.offset = {0.001f, 0, 0}}),
        command(Set{{"light.to_light", glm::vec3(0, 1, 0)}}),
        command(Set{{"light.irradiance", glm::vec3(1)}}),
        command(Set{{"light.rotate", 0.1f}}),
        command(Set{{"medium.extinction", 1.0f}}),
        command(Set{{"medium.falloff", 1.0f}}),
        command(Set{{"medium.anisotropy", 0.1f}}),
        command(Set{{"medium.asymmetry", 0.1f}}),
        command(Set{{"medium.second_asymmetry", 0.1f}}),
        command(Set{{"medium.droplet", 10.0f}}),
        command(Set{{"medium.phase", "rayleigh"}}),
        command(Set{{"medium.albedo", glm::vec3(0.1f)}}),
        command(Set{{"render.method", "isv"}}),
        command(Set{{"render.isv.quadrature", "analytic"}}),
        command(Set{{"render.isv.steps", 5u}}),
        command(Set{{"render.exposure", 2.0f}}),
        command(Set{{"simulation.paused", true}}),
    };
    Simulation unchanged(cubeScene());
    unchanged.step({});
    for (size_t i = 0; i < changes.size(); ++i) {
        Simulation changed(cubeScene());
        give(changed, {changes[i]});
        EXPECT_NE(changed.stateHash(), unchanged.stateHash()) << "change " << i;
    }
}

TEST_P(AnyLayout, StepAllocatesNothing) {
    Simulation simulation(sceneOf(GetParam()));
    const std::vector<Command> all{command(Impulse{.origin = {0, 0, 20}}), command(MoveVolume{.offset = {1, 0, 0}})};
    const std::vector<Command> sets{
        command(
            Set{{"light.to_light", glm::vec3(0, 1, 0)}, {"light.irradiance", glm::vec3(3)}, {"light.rotate", 1.0f}}),
        command(Set{{"medium.extinction", 10.0f},
                    {"medium.falloff", 1.0f},
                    {"medium.anisotropy", 0.5f},
                    {"medium.asymmetry", 0.5f},
                    {"medium.albedo", glm::vec3(0.5f)}}),
        command(Set{{"render.method", "a method with a name of some length"},
                    {"render.isv.quadrature", "transmittance"},
                    {"render.isv.steps", 3u},
                    {"render.exposure", 2.0f}}),
        command(Set{{"simulation.paused", false}}),
    };
    const std::vector<Command> restart{command(Restart{})};
    std::vector<gpu::Particle> out(simulation.capacity());
    simulation.step(sets); // which keeps for Undo how these were before
    const size_t before = allocations();
    for (int i = 0; i < 300; ++i) {
        simulation.step(i % 50 == 49 ? restart : all);
        simulation.write(std::span(out).first(simulation.liveCount()));
    }
    EXPECT_EQ(allocations(), before);
}

TEST_P(AnyLayout, BoundsHoldExactlyTheLiving) {
    Simulation simulation(sceneOf(GetParam()));
    for (int i = 0; i < 3; ++i) {
        give(simulation, {command(Impulse{.origin = {0, 0, 20}})});
        glm::vec3 lo(1e9f), hi(-1e9f);
        float scale = 0, sigma = 0;
        for (const gpu::Particle& p : particlesOf(simulation)) {
            lo = glm::min(lo, p.centre);
            hi = glm::max(hi, p.centre);
            scale = std::max(scale, p.scale);
            sigma = std::max(sigma, p.sigma_t);
        }
        EXPECT_EQ(simulation.bounds().lo, lo);
        EXPECT_EQ(simulation.bounds().hi, hi);
        EXPECT_EQ(simulation.bounds().max_scale, scale);
        EXPECT_EQ(simulation.bounds().max_sigma_t, sigma);
    }
}

TEST_P(AnyLayout, ImpulsePushesOnlyWhatIsNear) {
    Scene scene = sceneOf(GetParam());
    scene.simulation.impulse_radius = 1.5f;
    Simulation pushed(scene), calm(scene);
    const Impulse impulse{.origin = {0, 1.5f, 30}, .direction = {0, 0, -1}};
    const auto before = particlesOf(calm);
    give(pushed, {command(impulse)});
    calm.step({});
    const auto a = particlesOf(pushed), b = particlesOf(calm);
    ASSERT_EQ(a.size(), b.size());
    size_t near = 0;
    // The living keep their order; births of this tick stand at the end, deaths leave the front.
    const size_t dead = before.size() - std::min(before.size(), a.size());
    for (size_t i = 0; i + dead < before.size() && i < a.size(); ++i) {
        const glm::vec2 from_ray(b[i].centre.x, b[i].centre.y - 1.5f);
        const float distance = glm::length(from_ray);
        if (distance > 1.6f) {
            EXPECT_EQ(a[i].centre, b[i].centre) << i;
        } else if (distance < 1.3f && distance > 0.05f) {
            ++near;
            const glm::vec3 moved = a[i].centre - b[i].centre;
            EXPECT_GT(glm::dot(glm::vec2(moved.x, moved.y), from_ray), 0) << "not outward: " << i;
            EXPECT_LT(moved.z, 0) << "not along the ray: " << i;
        }
    }
    EXPECT_GT(near, 20u);
}

TEST(Impulse, ReachesOnlyForward) {
    Simulation pushed(cubeScene()), calm(cubeScene());
    give(pushed, {command(Impulse{.origin = {0, 0, 0}, .direction = {0, 0, -1}})});
    calm.step({});
    const auto a = particlesOf(pushed), b = particlesOf(calm);
    size_t moved = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        EXPECT_TRUE(b[i].centre.z < 0 || a[i].centre == b[i].centre);
        moved += a[i].centre != b[i].centre;
    }
    EXPECT_GT(moved, 10u);
}

TEST(Spring, ParticlesComeHomeAndStay) {
    Simulation simulation(cubeScene());
    const auto home = particlesOf(simulation);
    run(simulation, 10);
    EXPECT_EQ(particlesOf(simulation)[7].centre, home[7].centre) << "moves although nothing pushes";
    give(simulation, {command(Impulse{.origin = {0, 0, 20}})});
    EXPECT_GT(glm::distance(meanOf(particlesOf(simulation)), meanOf(home)), 1e-4f);
    run(simulation, 20 * 60);
    const auto now = particlesOf(simulation);
    for (size_t i = 0; i < now.size(); ++i) ASSERT_LT(glm::distance(now[i].centre, home[i].centre), 1e-3f) << i;
}

TEST(Volume, MovesByCommandAndTakesItsParticlesAlong) {
    Simulation simulation(cubeScene());
    const auto home = particlesOf(simulation);
    give(simulation, {command(MoveVolume{.offset = {3, 0, 0}}), command(MoveVolume{.offset = {0, -2, 1}})});
    run(simulation, 20 * 60);
    const auto now = particlesOf(simulation);
    for (size_t i = 0; i < now.size(); ++i)
        ASSERT_LT(glm::distance(now[i].centre, home[i].centre + glm::vec3(3, -2, 1)), 2e-3f) << i;
}

TEST(Volume, DriftsAndSways) {
    Scene scene = cubeScene(100);
    scene.simulation.spring = 200; // stiff, so that particles follow closely
    scene.simulation.viscosity = 30;
    scene.simulation.volume_velocity = {0, 0.5f, 0};
    scene.simulation.volume_swing = 2;
    scene.simulation.volume_period = 40;
    Simulation simulation(scene);
    const glm::vec3 start = meanOf(particlesOf(simulation));
    run(simulation, 600); // a quarter of the period
    const glm::vec3 moved = meanOf(particlesOf(simulation)) - start;
    EXPECT_NEAR(moved.x, 2, 0.02f);
    EXPECT_NEAR(moved.y, 5, 0.15f);
    EXPECT_NEAR(moved.z, 0, 1e-4f);
}

TEST(Volume, MovesAnEmittersSourceNotItsSmoke) {
    Simulation simulation(plumeScene()), still(plumeScene());
    give(simulation, {command(MoveVolume{.offset = {5, 0, 0}})});
    still.step({});
    const auto a = particlesOf(simulation), b = particlesOf(still);
    EXPECT_EQ(a.front().centre, b.front().centre);
    EXPECT_NEAR(a.back().centre.x - b.back().centre.x, 5, 1e-5f);
}

TEST_P(AnyLayout, PausedTakesCommandsButMovesNothing) {
    Simulation simulation(sceneOf(GetParam()));
    give(simulation, {command(Set{{"simulation.paused", true}})});
    const auto before = particlesOf(simulation);
    const uint64_t hash = simulation.stateHash();
    run(simulation, 5);
    EXPECT_EQ(simulation.tick(), 6u);
    EXPECT_EQ(simulation.stateHash(), hash);
    give(simulation, {command(Set{{"medium.extinction", 30.0f}})});
    const auto after = particlesOf(simulation);
    ASSERT_EQ(after.size(), before.size());
    for (size_t i = 0; i < after.size(); ++i) {
        EXPECT_EQ(after[i].centre, before[i].centre);
        EXPECT_NEAR(after[i].sigma_t, 2 * before[i].sigma_t, 1e-6f); // twice the 15 of before
    }
    EXPECT_EQ(simulation.tick(), 7u);
}

TEST_P(AnyLayout, RestartIsTheStartAtALaterTick) {
    Simulation simulation(sceneOf(GetParam()));
    const uint64_t first = simulation.stateHash();
    simulation.step({});
    const uint64_t second = simulation.stateHash();
    hashesOf(simulation);
    give(simulation, {command(Restart{}), command(Set{{"simulation.paused", true}})});
    EXPECT_EQ(simulation.tick(), 122u);
    give(simulation, {command(Set{{"simulation.paused", false}}), command(Restart{})});
    EXPECT_EQ(simulation.stateHash(), second);
    EXPECT_NE(first, second);
    EXPECT_EQ(simulation.now().render.method, "sphere");
    EXPECT_EQ(simulation.now().medium.extinction, 15);
}

TEST_P(AnyLayout, NumbersThatAreNotFiniteChangeNothing) {
    Simulation disturbed(sceneOf(GetParam())), calm(sceneOf(GetParam()));
    for (const float bad : {kNaN, kInf, -kInf}) {
        const glm::vec3 v(0, bad, 0);
        give(disturbed, {command(Impulse{.origin = v}), command(Impulse{.direction = v}),
                         command(Impulse{.direction = {0, 0, -1}, .push = v}),
                         command(Impulse{.direction = {0, 0, -1}, .strength = bad}),
                         command(Impulse{.direction = {0, 0, 0}}), command(MoveVolume{.offset = v}),
                         command(Set{{"light.to_light", v}, {"light.irradiance", v}, {"light.rotate", bad}}),
                         command(Set{{"light.to_light", glm::vec3(0)}}),
                         command(Set{{"medium.extinction", bad},
                                     {"medium.falloff", bad},
                                     {"medium.anisotropy", bad},
                                     {"medium.asymmetry", bad},
                                     {"medium.albedo", v}}),
                         command(Set{{"render.method", ""},
                                     {"render.isv.quadrature", std::string(1000, 'x')},
                                     {"render.exposure", bad}})});
        calm.step({});
    }
    EXPECT_EQ(disturbed.stateHash(), calm.stateHash());
}

TEST_P(AnyLayout, HugeNumbersAreClamped) {
    Simulation simulation(sceneOf(GetParam()));
    const glm::vec3 huge(3e38f, -3e38f, 3e38f);
    for (int i = 0; i < 200; ++i)
        give(simulation,
             {command(Impulse{.origin = {0, 0, 20}, .direction = {0, 0, -1}, .push = huge, .strength = 3e38f}),
              command(MoveVolume{.offset = huge}),
              command(Set{{"light.to_light", huge}, {"light.irradiance", huge}, {"light.rotate", 3e38f}}),
              command(Set{{"medium.extinction", 3e38f},
                          {"medium.falloff", -3e38f},
                          {"medium.anisotropy", 9.0f},
                          {"medium.asymmetry", 9.0f},
                          {"medium.albedo", huge}}),
              command(Set{{"render.isv.quadrature", "transmittance"},
                          {"render.isv.steps", 4'000'000'000u},
                          {"render.exposure", -3.0f}})});
    for (const gpu::Particle& p : particlesOf(simulation)) {
        ASSERT_TRUE(std::isfinite(p.centre.x + p.centre.y + p.centre.z));
        ASSERT_TRUE(std::isfinite(p.sigma_t) && p.sigma_t >= 0);
    }
    const SceneNow& now = simulation.now();
    EXPECT_NEAR(glm::length(now.light.to_light), 1, 1e-5f);
    EXPECT_EQ(now.light.irradiance, glm::vec3(1e4f, 0, 1e4f));
    EXPECT_EQ(now.light.rotate, 10);
    EXPECT_EQ(now.medium.falloff, 0.1f);
    EXPECT_EQ(now.medium.asymmetry, 0.99f);
    EXPECT_EQ(now.medium.albedo, glm::vec3(1, 0, 1));
    EXPECT_EQ(now.render.isv.steps, 3u);
    EXPECT_GT(now.render.exposure, 0);
}

// A scene without a light is dark until a command gives it one.
TEST(Light, OfASceneWithoutIsDarkAndMayBeTurnedOn) {
    Scene scene = cubeScene(1);
    scene.lights.clear();
    Simulation simulation(scene);
    EXPECT_EQ(simulation.now().light.irradiance, glm::vec3(0));
    give(simulation, {command(Set{{"light.irradiance", glm::vec3(1, 2, 3)}})});
    EXPECT_EQ(simulation.now().light.irradiance, glm::vec3(1, 2, 3));
}

TEST(Light, TurnsAboutY) {
    Scene scene = cubeScene(1);
    scene.lights[0].rotate = 0.5f;
    Simulation simulation(scene);
    run(simulation, 120); // 1 rad
    const glm::vec3 expected(0.6f * std::cos(1.0f), 0.8f, -0.6f * std::sin(1.0f));
    EXPECT_LT(glm::distance(simulation.now().light.to_light, expected), 1e-4f);
}

TEST(Light, TurnsAboutAnyAxis) {
    const auto after = [](glm::vec3 axis, glm::vec3 to_light, int ticks) {
        Scene scene = cubeScene(1);
        scene.lights[0].to_light = to_light;
        scene.lights[0].rotate = 0.5f;
        scene.lights[0].rotate_axis = axis;
        Simulation simulation(scene);
        run(simulation, ticks);
        return simulation.now().light.to_light;
    };
    const float c = std::cos(1.0f), s = std::sin(1.0f);
    const glm::vec3 z(0, 0, 1);
    EXPECT_LT(glm::distance(after(z, {1, 0, 0}, 120), glm::vec3(c, s, 0)), 1e-4f);
    EXPECT_LT(glm::distance(after(-z, {0, 1, 0}, 120), glm::vec3(s, c, 0)), 1e-4f);
    EXPECT_LT(glm::distance(after({1, 0, 0}, {0.6f, 0.8f, 0}, 120), glm::vec3(0.6f, 0.8f * c, 0.8f * s)), 1e-4f);
    EXPECT_EQ(after({0, 1, 0}, {0.6f, 0.8f, 0}, 120).y, after({0, 1, 0}, {0.6f, 0.8f, 0}, 119).y);
    // A third of a turn about a diagonal takes x to y. 251 ticks are a little less.
    const float lacks = 2 * std::numbers::pi_v<float> / 3 - 0.5f * 251 / 60; // rad
    const glm::vec3 diagonal = glm::normalize(glm::vec3(1)), got = after(diagonal, {1, 0, 0}, 251);
    EXPECT_NEAR(glm::distance(got, glm::vec3(0, 1, 0)), lacks * std::sqrt(2.0f / 3), 1e-4f);
    EXPECT_NEAR(glm::dot(got, diagonal), glm::dot(glm::vec3(1, 0, 0), diagonal), 1e-4f);
}

TEST(Light, OrbitsItsPivotAndStartsAnew) {
    Scene scene = cubeScene(1);
    scene.lights.push_back({.type = kPoint, .position = {3, 2, 1}, .orbit = 0.5f, .pivot = {1, 0, 1}});
    Simulation simulation(scene);
    run(simulation, 120); // 1 rad
    const glm::vec3 expected(1 + 2 * std::cos(1.0f), 2, 1 - 2 * std::sin(1.0f));
    EXPECT_LT(glm::distance(simulation.now().lists.lights.at(0).position, expected), 1e-4f);
    give(simulation, {command(Restart{})}); // and one step
    EXPECT_LT(glm::distance(simulation.now().lists.lights.at(0).position, glm::vec3(3, 2, 1)), 0.02f);
}

} // namespace
} // namespace brume::simulation_test

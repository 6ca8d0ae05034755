// The shared simulation: the same commands give the same bits, and what it does to particles is what its comments say.
#include "server/sim/simulation.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "server/sim/kernels.h"
#include "server/sim/layout.h"
#include "server/sim/random.h"
#include "server/sim/sine.h"
#include "tests/unit/allocations.h"

namespace brume {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kDt = static_cast<float>(kTickSeconds);

Scene cubeScene(uint32_t count = 1000, uint64_t seed = 1) {
    Scene scene;
    scene.lights.push_back({.to_light = {0.6f, 0.8f, 0}});
    scene.medium.count = count;
    scene.medium.seed = seed;
    return scene;
}

Scene plumeScene(uint64_t seed = 1) {
    Scene scene = cubeScene(1000, seed);
    scene.medium.layout = Layout::emitter;
    scene.medium.scale = {0.5f, 1};
    scene.medium.emitter.rate = 300;
    scene.medium.emitter.life = 3;
    return scene;
}

Scene sceneOf(Layout layout) { return layout == Layout::emitter ? plumeScene() : cubeScene(); }

Command command(CommandBody body) { return {.viewer = 1, .seq = 1, .body = std::move(body)}; }

void run(Simulation& simulation, int ticks) {
    for (int i = 0; i < ticks; ++i) simulation.step({});
}
void give(Simulation& simulation, std::vector<Command> commands) { simulation.step(commands); }

std::vector<gpu::Particle> particlesOf(const Simulation& simulation) {
    std::vector<gpu::Particle> out(simulation.liveCount());
    simulation.write(out);
    return out;
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
        {20, command(SetLight{.to_light = glm::vec3(1, 2, 3), .rotate = 0.7f})},
        {30, command(SetMedium{.extinction = 40.0f, .falloff = 1.4f, .asymmetry = 0.3f})},
        {40, command(SetRender{.method = "isv", .steps = 4u, .exposure = 1.5f})},
        {50, command(SetSimulation{.paused = true})},
        {55, command(SetSimulation{.paused = false})},
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

// Frozen: the same with GCC and Clang, with and without AVX2, in every build type. A change here breaks replays: make it on
// purpose.
TEST(Hash, IsTheSameWithEveryCompiler) {
    Simulation cube(cubeScene()), plume(plumeScene());
    EXPECT_EQ(hashesOf(cube).back(), 0x26c76a01bacd1267u);
    EXPECT_EQ(hashesOf(plume).back(), 0x01f4c770241ca698u);
    Scene scene = cubeScene(2000);
    scene.medium.layout = Layout::cumulus;
    scene.medium.scale = {0.5f, 3};
    EXPECT_EQ(Simulation(scene).stateHash(), 0x4544dfc46a3f3e6bu);
    scene.medium.layout = Layout::tubes;
    EXPECT_EQ(Simulation(scene).stateHash(), 0x70af364c7d587537u);
}

TEST(Hash, OrderOfCommandsMatters) {
    const Command thin = command(SetMedium{.extinction = 5.0f});
    const Command thick = command(SetMedium{.extinction = 50.0f});
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
        command(SetLight{.to_light = glm::vec3(0, 1, 0)}),
        command(SetLight{.irradiance = glm::vec3(1)}),
        command(SetLight{.rotate = 0.1f}),
        command(SetMedium{.extinction = 1.0f}),
        command(SetMedium{.falloff = 1.0f}),
        command(SetMedium{.anisotropy = 0.1f}),
        command(SetMedium{.asymmetry = 0.1f}),
        command(SetMedium{.albedo = glm::vec3(0.1f)}),
        command(SetRender{.method = "isv"}),
        command(SetRender{.quadrature = "analytic"}),
        command(SetRender{.steps = 5u}),
        command(SetRender{.exposure = 2.0f}),
        command(SetSimulation{.paused = true}),
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
    const std::vector<Command> all{
        command(Impulse{.origin = {0, 0, 20}}),
        command(MoveVolume{.offset = {1, 0, 0}}),
        command(SetLight{.to_light = glm::vec3(0, 1, 0), .irradiance = glm::vec3(3), .rotate = 1.0f}),
        command(
            SetMedium{.extinction = 10.0f, .falloff = 1.0f, .anisotropy = 0.5f, .asymmetry = 0.5f, .albedo = glm::vec3(0.5f)}),
        command(SetRender{
            .method = "a method with a name of some length", .quadrature = "transmittance", .steps = 3u, .exposure = 2.0f}),
        command(SetSimulation{.paused = false}),
    };
    const std::vector<Command> restart{command(Restart{})};
    std::vector<gpu::Particle> out(simulation.capacity());
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
    give(simulation, {command(SetSimulation{.paused = true})});
    const auto before = particlesOf(simulation);
    const uint64_t hash = simulation.stateHash();
    run(simulation, 5);
    EXPECT_EQ(simulation.tick(), 6u);
    EXPECT_EQ(simulation.stateHash(), hash);
    give(simulation, {command(SetMedium{.extinction = 30.0f})});
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
    give(simulation, {command(Restart{}), command(SetSimulation{.paused = true})});
    EXPECT_EQ(simulation.tick(), 122u);
    give(simulation, {command(SetSimulation{.paused = false}), command(Restart{})});
    EXPECT_EQ(simulation.stateHash(), second);
    EXPECT_NE(first, second);
    EXPECT_EQ(simulation.now().render.method, "sphere");
    EXPECT_EQ(simulation.now().medium.extinction, 15);
}

TEST_P(AnyLayout, NumbersThatAreNotFiniteChangeNothing) {
    Simulation disturbed(sceneOf(GetParam())), calm(sceneOf(GetParam()));
    for (const float bad : {kNaN, kInf, -kInf}) {
        const glm::vec3 v(0, bad, 0);
        give(disturbed,
             {command(Impulse{.origin = v}), command(Impulse{.direction = v}),
              command(Impulse{.direction = {0, 0, -1}, .push = v}), command(Impulse{.direction = {0, 0, -1}, .strength = bad}),
              command(Impulse{.direction = {0, 0, 0}}), command(MoveVolume{.offset = v}),
              command(SetLight{.to_light = v, .irradiance = v, .rotate = bad}), command(SetLight{.to_light = glm::vec3(0)}),
              command(SetMedium{.extinction = bad, .falloff = bad, .anisotropy = bad, .asymmetry = bad, .albedo = v}),
              command(SetRender{.method = "", .quadrature = std::string(1000, 'x'), .exposure = bad})});
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
              command(MoveVolume{.offset = huge}), command(SetLight{.to_light = huge, .irradiance = huge, .rotate = 3e38f}),
              command(SetMedium{.extinction = 3e38f, .falloff = -3e38f, .anisotropy = 9.0f, .asymmetry = 9.0f, .albedo = huge}),
              command(SetRender{.quadrature = "transmittance", .steps = 4'000'000'000u, .exposure = -3.0f})});
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
    EXPECT_EQ(now.render.steps, 3u);
    EXPECT_GT(now.render.exposure, 0);
}

TEST(Light, TurnsAboutY) {
    Scene scene = cubeScene(1);
    scene.lights[0].rotate = 0.5f;
    Simulation simulation(scene);
    run(simulation, 120); // 1 rad
    const glm::vec3 expected(0.6f * std::cos(1.0f), 0.8f, -0.6f * std::sin(1.0f));
    EXPECT_LT(glm::distance(simulation.now().light.to_light, expected), 1e-4f);
}

TEST(Emitter, IsFullFromTheFirstPictureOn) {
    Simulation simulation(plumeScene());
    EXPECT_EQ(simulation.tick(), 0u);
    EXPECT_NEAR(simulation.liveCount(), 900, 6); // rate * life
    for (int i = 0; i < 400; ++i) {
        simulation.step({});
        ASSERT_NEAR(simulation.liveCount(), 900, 6);
    }
}

TEST(Emitter, AFullPoolNeverOverflows) {
    Scene scene = plumeScene();
    scene.medium.count = 900; // exactly rate * life
    Simulation simulation(scene);
    for (int i = 0; i < 400; ++i) {
        simulation.step({});
        ASSERT_LE(simulation.liveCount(), 900u);
        ASSERT_GE(simulation.liveCount(), 894u);
    }
}

TEST(Emitter, OpticalMassIsConserved) {
    Scene scene = plumeScene();
    scene.medium.scale = {0.5f, 0.5f};
    scene.medium.multiplier = {8, 8};
    scene.medium.emitter.growth = 0.4f;
    const Simulation simulation(scene);
    const float sigma0 = scene.medium.extinction * 8e-4f, mass0 = sigma0 * 0.125f, life = scene.medium.emitter.life;
    size_t grown = 0;
    float oldest = 1e9f;
    for (const gpu::Particle& p : particlesOf(simulation)) {
        const float age = (p.scale - 0.5f) / 0.4f, mass = p.sigma_t * p.scale * p.scale * p.scale;
        EXPECT_LE(age, oldest) << "not in the order of births";
        oldest = age;
        EXPECT_LE(mass, mass0 * 1.00001f);
        if (age > 0.1f * life + 0.01f && age < (1 - Ageing::kDissolve) * life - 0.01f) {
            EXPECT_NEAR(mass, mass0, mass0 * 1e-5f);
            ++grown;
        }
        const bool at_an_end = age < 0.02f || age > 0.99f * life;
        EXPECT_TRUE(!at_an_end || mass < 0.02f * mass0) << "pops in or out at age " << age;
    }
    EXPECT_GT(grown, 400u);
}

// In still air dv/dt = -c v + b (1 - t / T) has a closed form; in wind w, x = w (t - (1 - exp(-c t)) / c).
TEST(Emitter, RisesAndLeansIntoTheWindAsTheClosedFormSays) {
    Scene scene = plumeScene();
    Emitter& emitter = scene.medium.emitter;
    emitter.turbulence = emitter.spread = 0;
    emitter.radius = 1e-3f;
    emitter.wind = {1, 0, 0};
    scene.medium.scale = {1, 1};
    const double c = scene.simulation.viscosity, b = emitter.buoyancy, life = emitter.life, v0 = emitter.velocity.y;
    const double start = b / c + b / (c * c * life); // of the particular solution, which falls by b / (c T) a second
    const Simulation simulation(scene);
    size_t old = 0;
    for (const gpu::Particle& p : particlesOf(simulation)) {
        const double t = (p.scale - 1) / emitter.growth, faded = (1 - std::exp(-c * t)) / c;
        EXPECT_NEAR(p.centre.y, start * t - b / (c * life) * t * t / 2 + (v0 - start) * faded, 0.03) << "age " << t;
        EXPECT_NEAR(p.centre.x, t - faded, 0.03) << "age " << t;
        old += t > 2.5;
    }
    EXPECT_GT(old, 100u);
}

// dv/dt = viscosity (air - v): towards the turbulence's own velocity, in whole tiles of lanes as in what is left over.
TEST(Kernels, SmokeFollowsTheTurbulenceAtItsPlace) {
    const Turbulence turbulence(3, 2, 4, {0.5f, 0, 0});
    const Turbulence::Modes modes = turbulence.at(1.25);
    constexpr uint32_t kRows = 37, kBegin = 3, kEnd = 36;
    Columns columns(kRows);
    Random random(9);
    std::vector<glm::vec3> places;
    for (uint32_t i = 0; i < kRows; ++i) {
        places.push_back(random.inBox() * 20.0f);
        columns[Column::x][i] = places[i].x;
        columns[Column::y][i] = places[i].y;
        columns[Column::z][i] = places[i].z;
    }
    plumeStep(columns, {kBegin, kEnd}, {.dt = kDt, .viscosity = 3, .wind = {0.5f, 0, 0}, .buoyancy = 0, .life = 5}, modes);
    for (uint32_t i = 0; i < kRows; ++i) {
        const glm::vec3 v(columns[Column::vx][i], columns[Column::vy][i], columns[Column::vz][i]);
        const float share = 3 * kDt / (1 + 3 * kDt);
        const glm::vec3 air = velocityAt(modes, places[i]) + glm::vec3(0.5f, 0, 0);
        const bool taken = i >= kBegin && i < kEnd;
        EXPECT_LT(glm::distance(v, taken ? share * air : glm::vec3(0)), 1e-5f) << i;
        EXPECT_NEAR(columns[Column::age][i], taken ? kDt : 0, 1e-9f) << i;
    }
}

// Central differences; the same field with its amplitudes turned along the waves, as a control, has a divergence.
TEST(Turbulence, HasNoDivergence) {
    const Turbulence::Modes modes = Turbulence(7, 1.5f, 3, {0, 0, 0}).at(2.0);
    Turbulence::Modes control = modes;
    for (Mode& mode : control) mode.amplitude = glm::normalize(mode.wave) * glm::length(mode.amplitude);
    const auto divergence = [](const Turbulence::Modes& field, glm::vec3 place) {
        constexpr float kStep = 5e-3f;
        float sum = 0;
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 step(0);
            step[axis] = kStep;
            sum += (velocityAt(field, place + step)[axis] - velocityAt(field, place - step)[axis]) / (2 * kStep);
        }
        return sum;
    };
    Random random(1);
    double squares = 0, control_squares = 0;
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 place = random.inBox() * 5.0f;
        squares += std::pow(divergence(modes, place), 2);
        control_squares += std::pow(divergence(control, place), 2);
    }
    EXPECT_LT(std::sqrt(squares / 500), 2e-3 * std::sqrt(control_squares / 500));
    for (const Mode& mode : modes) EXPECT_LT(std::abs(glm::dot(mode.amplitude, mode.wave)), 1e-6f);
}

TEST(Turbulence, HasItsRmsAndChangesSlowly) {
    const Turbulence turbulence(7, 1.5f, 3, {0, 0, 0});
    Random random(2);
    double squares = 0, change = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 place = random.inBox() * 100.0f, now = velocityAt(turbulence.at(0), place);
        squares += static_cast<double>(glm::dot(now, now));
        const glm::vec3 later = velocityAt(turbulence.at(0.05), place) - now;
        change += static_cast<double>(glm::dot(later, later));
    }
    EXPECT_NEAR(std::sqrt(squares / 20000), 1.5, 0.05);
    EXPECT_GT(change, 0);
    EXPECT_LT(std::sqrt(change / 20000), 0.5);
}

TEST(Sine, IsClosePeriodicAndOdd) {
    for (int i = -4000; i <= 4000; ++i) {
        const float x = static_cast<float>(i) / 1000;
        EXPECT_NEAR(sineOfTurns(x), std::sin(2 * 3.14159265358979 * static_cast<double>(x)), 2e-3) << x;
        EXPECT_EQ(sineOfTurns(-x), -sineOfTurns(x));
    }
}

TEST(Layouts, CubeFillsItsCube) {
    const Placement placed = place(cubeScene(20000).medium);
    glm::dvec3 sum(0), squares(0);
    for (const glm::vec3& p : placed.position) {
        for (int axis = 0; axis < 3; ++axis) ASSERT_LE(std::abs(p[axis]), 5);
        sum += glm::dvec3(p);
        squares += glm::dvec3(p * p);
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(sum[axis] / 20000, 0, 0.06);
        EXPECT_NEAR(squares[axis] / 20000, 100.0 / 12, 0.2); // a uniform side of 10
    }
    for (const float m : placed.multiplier) ASSERT_TRUE(m >= 5 && m < 10);
}

TEST(Layouts, TubesCrossWithAGap) {
    Medium medium = cubeScene(2000).medium;
    medium.layout = Layout::tubes;
    const Placement placed = place(medium);
    for (size_t i = 0; i < placed.position.size(); ++i) {
        const glm::vec3 p = placed.position[i];
        const float across = i % 2 == 0 ? p.x : p.z, along = i % 2 == 0 ? p.z : p.x;
        EXPECT_EQ(p.y > 0, i % 2 == 0);
        EXPECT_LE(std::hypot(across, std::abs(p.y) - 1.6f), 1.2001f);
        EXPECT_LE(std::abs(along), 5);
    }
}

TEST(Layouts, CumulusStandsOnItsBaseWithItsDetailOutside) {
    Medium medium = cubeScene(8000).medium;
    medium.layout = Layout::cumulus;
    medium.extent = 20;
    medium.scale = {0.5f, 6};
    medium.centre = {0, 30, 0};
    const Placement placed = place(medium);
    ASSERT_EQ(placed.position.size(), 8000u);
    float lo = 1e9f, hi = -1e9f, top = 0;
    size_t low = 0, small = 0;
    for (size_t i = 0; i < 8000; ++i) {
        const glm::vec3 p = placed.position[i] - medium.centre;
        ASSERT_GE(p.y, 0);
        lo = std::min(lo, p.x);
        hi = std::max(hi, p.x);
        top = std::max(top, p.y);
        low += p.y < 1;
        small += placed.scale[i] < 1;
        ASSERT_TRUE(placed.scale[i] >= 0.5f && placed.scale[i] <= 6);
    }
    EXPECT_NEAR(hi - lo, 20, 0.5);
    EXPECT_GT(top, 6);       // it towers
    EXPECT_GT(low, 400u);    // on a base
    EXPECT_GT(small, 4000u); // small particles are many, large ones few
    EXPECT_GT(8000 - small, 100u);
}

TEST(Layouts, AFileBringsItsOwnParticles) {
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "simulation_test.ply";
    const std::string xyz = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
    std::ofstream(file) << xyz << "end_header\n1 2 3\n4 5 6\n";
    Scene scene = cubeScene();
    scene.medium.layout = Layout::file;
    scene.medium.file = file;
    scene.medium.centre = {10, 0, 0};
    const SetMedium change{.extinction = 30.0f, .albedo = glm::vec3(0.5f)};
    {
        Simulation simulation(scene);
        const auto before = particlesOf(simulation);
        ASSERT_EQ(before.size(), 2u);
        EXPECT_EQ(simulation.now().medium.count, 2u);
        EXPECT_EQ(before[1].centre, glm::vec3(14, 5, 6));
        EXPECT_EQ(before[0].scale, 6);
        give(simulation, {command(change)});
        EXPECT_NEAR(particlesOf(simulation)[0].sigma_t, 2 * before[0].sigma_t, 1e-6f);
        EXPECT_EQ(particlesOf(simulation)[0].albedo, glm::vec3(0.5f));
    }
    std::ofstream(file) << xyz << "property float scale\nproperty float sigma_t\nproperty uchar red\nproperty uchar green\n"
                        << "property uchar blue\nend_header\n1 2 3 0.5 7 255 0 0\n4 5 6 0.25 8 0 255 0\n";
    Simulation simulation(scene);
    give(simulation, {command(change)});
    const auto own = particlesOf(simulation);
    EXPECT_EQ(own[0].scale, 0.5f);
    EXPECT_EQ(own[0].sigma_t, 7);
    EXPECT_EQ(own[1].sigma_t, 8);
    EXPECT_EQ(own[1].albedo, glm::vec3(0, 1, 0));
    EXPECT_EQ(simulation.bounds().max_sigma_t, 8);

    scene.medium.file = "no/such.ply";
    EXPECT_THROW(Simulation{scene}, SceneError);
}

} // namespace
} // namespace brume

// Emitters: how many live, their smoke against closed forms, the turbulence that carries it and the sine in that.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.h"
#include "server/sim/kernels.h"
#include "server/sim/sine.h"
#include "tests/unit/simulation_scenes.h"

namespace brume {
namespace {

constexpr float kDt = static_cast<float>(kTickSeconds);

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

// Albedos near the medium's as e^(-age / cooling), each colour by its own time; so what is emitted fades.
TEST(Emitter, ItsParticlesCoolByEachColoursTime) {
    Scene scene = plumeScene();
    EXPECT_EQ(particlesOf(Simulation(scene)).front().albedo, scene.medium.albedo) << "without cooling";
    scene.medium.albedo = {0.4f, 0.5f, 0.6f};
    scene.medium.scale = {0.5f, 0.5f};
    Emitter& emitter = scene.medium.emitter;
    emitter.growth = 0.4f;
    emitter.albedo = {0, 0.25f, 0.6f};
    emitter.cooling = {0.8f, 0.3f, 0};
    Simulation simulation(scene);
    const auto expectCooled = [&](glm::dvec3 factor) {
        for (const gpu::Particle& p : particlesOf(simulation)) {
            const double age = double(p.scale - 0.5f) / double(emitter.growth);
            EXPECT_NEAR(p.albedo.x, factor.x * 0.4 * (1 - std::exp(-age / 0.8)), 1e-5) << age;
            EXPECT_NEAR(p.albedo.y, factor.y * (0.5 - 0.25 * std::exp(-age / 0.3)), 1e-5) << age;
            EXPECT_NEAR(p.albedo.z, factor.z * 0.6, 1e-6) << age;
        }
    };
    expectCooled(glm::dvec3(1));
    const Command halved[] = {command(Set{{"medium.albedo", glm::vec3(0.2f, 0.5f, 0.6f)}})};
    simulation.step(halved);
    expectCooled({0.5, 1, 1});
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
    plumeStep(columns, {kBegin, kEnd}, {.dt = kDt, .viscosity = 3, .wind = {0.5f, 0, 0}, .buoyancy = 0, .life = 5},
              modes);
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

} // namespace
} // namespace brume

// Layout `live`: particles that messages set and move.
#include "server/sim/live.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/allocations.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::live_test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Scene liveScene(uint32_t rows = 8) {
    Scene scene = cubeScene(rows);
    scene.medium.layout = Layout::live;
    scene.medium.extinction = 10;
    scene.medium.albedo = glm::vec3(0.5f, 0.25f, 1);
    return scene;
}

// Particles on the x axis.
SetParticles rowsAt(std::vector<float> places, uint32_t live, float seconds = 0, uint32_t first = 0) {
    ParticleRows rows;
    for (const float x : places) rows.positions.emplace_back(x, 0, 0);
    rows.scales.assign(places.size(), 2);
    rows.extinctions.assign(places.size(), 0.5f);
    return {first, live, seconds, std::make_shared<const ParticleRows>(std::move(rows))};
}
SetParticles changed(SetParticles set, auto&& change) {
    ParticleRows rows = *set.rows;
    change(rows);
    set.rows = std::make_shared<const ParticleRows>(std::move(rows));
    return set;
}

TEST(Live, BeginsEmptyAndShowsWhatIsSetAtOnce) {
    Scene scene = liveScene();
    scene.medium.centre = {0, 3, 0};
    Simulation simulation(scene);
    EXPECT_EQ(simulation.capacity(), 8u);
    EXPECT_EQ(simulation.liveCount(), 0u);
    EXPECT_EQ(simulation.bounds().lo, glm::vec3(0, 3, 0));
    EXPECT_EQ(simulation.bounds().hi, glm::vec3(0, 3, 0));
    give(simulation, {command(changed(rowsAt({1, 2}, 2), [](ParticleRows& rows) {
             rows.albedos = {{0.125f, 0.25f, 0.5f}, {1, 0, 0.75f}};
         }))});
    const auto now = particlesOf(simulation);
    ASSERT_EQ(now.size(), 2u);
    EXPECT_EQ(now[0].centre, glm::vec3(1, 3, 0));
    EXPECT_EQ(now[1].centre, glm::vec3(2, 3, 0));
    EXPECT_EQ(now[0].scale, 2);
    EXPECT_EQ(now[0].sigma_t, 0.5f);
    EXPECT_EQ(now[1].albedo, glm::vec3(1, 0, 0.75f));
    EXPECT_EQ(simulation.bounds().lo, glm::vec3(1, 3, 0));
    EXPECT_EQ(simulation.bounds().hi, glm::vec3(2, 3, 0));
}

// In closed form: after n of N steps, n / N of the way.
TEST(Live, MovesEvenlyInTheTimeThatTheMessageSays) {
    Simulation simulation(liveScene());
    give(simulation, {command(rowsAt({0, 10}, 2))});
    give(simulation, {command(changed(rowsAt({6, 10}, 2, 0.1f), [](ParticleRows& rows) { // 6 steps
             rows.scales[0] = 8;
             rows.extinctions[0] = 3.5f;
             rows.albedos = {{1, 1, 0}, {0.5f, 0.25f, 1}};
         }))});
    for (int n = 1; n <= 8; ++n) {
        const float part = float(std::min(n, 6)) / 6;
        const auto now = particlesOf(simulation);
        EXPECT_NEAR(now[0].centre.x, 6 * part, 1e-5f) << n;
        EXPECT_NEAR(now[0].scale, 2 + 6 * part, 1e-5f) << n;
        EXPECT_NEAR(now[0].sigma_t, 0.5f + 3 * part, 1e-5f) << n;
        EXPECT_NEAR(now[0].albedo.y, 0.25f + 0.75f * part, 1e-5f) << n;
        EXPECT_EQ(now[1].centre.x, 10);
        simulation.step({});
    }
    EXPECT_EQ(particlesOf(simulation)[0].centre.x, 6) << "exactly";
    EXPECT_EQ(particlesOf(simulation)[0].scale, 8);
}

TEST(Live, ANewMessageTakesOverFromWhereTheParticleIs) {
    Simulation simulation(liveScene());
    give(simulation, {command(rowsAt({0}, 1))});
    give(simulation, {command(rowsAt({6}, 1, 0.1f))});
    simulation.step({});
    simulation.step({}); // three of six steps
    EXPECT_NEAR(particlesOf(simulation)[0].centre.x, 3, 1e-5f);
    give(simulation, {command(rowsAt({0}, 1, 0.05f))}); // back, in three
    EXPECT_NEAR(particlesOf(simulation)[0].centre.x, 2, 1e-5f);
    simulation.step({});
    simulation.step({});
    EXPECT_EQ(particlesOf(simulation)[0].centre.x, 0);
    give(simulation, {command(rowsAt({6}, 1, 0.1f))});
    give(simulation, {command(rowsAt({5}, 1))});
    EXPECT_EQ(particlesOf(simulation)[0].centre.x, 5) << "at once";
    simulation.step({});
    EXPECT_EQ(particlesOf(simulation)[0].centre.x, 5);
}

TEST(Live, WhoComesIsThereAtOnceAndWhoGoesIsGone) {
    Simulation simulation(liveScene());
    give(simulation, {command(rowsAt({0, 1}, 2))});
    give(simulation, {command(rowsAt({2, 3, 4}, 3, 1))});
    EXPECT_EQ(particlesOf(simulation)[2].centre.x, 4) << "no way from where nothing was";
    EXPECT_LT(particlesOf(simulation)[0].centre.x, 1);
    give(simulation, {command(rowsAt({}, 1))});
    EXPECT_EQ(particlesOf(simulation).size(), 1u);
    give(simulation, {command(rowsAt({}, 3))});
    EXPECT_EQ(particlesOf(simulation)[1].centre.x, 3) << "a row keeps what was said of it";
    EXPECT_EQ(particlesOf(simulation)[2].centre.x, 4);
    give(simulation, {command(rowsAt({}, 0))});
    EXPECT_EQ(simulation.liveCount(), 0u);
}

// A sender fills rows that are not there yet and shows them all with the last message.
TEST(Live, RowsMayBeSetBeforeTheyAreThere) {
    Simulation simulation(liveScene());
    give(simulation, {command(rowsAt({4, 5}, 0, 0, 2)), command(rowsAt({6}, 0, 0, 5))});
    EXPECT_EQ(simulation.liveCount(), 0u);
    give(simulation, {command(rowsAt({}, 6))});
    const auto now = particlesOf(simulation);
    EXPECT_EQ(now[2].centre.x, 4);
    EXPECT_EQ(now[3].centre.x, 5);
    EXPECT_EQ(now[5].centre.x, 6);
    for (const size_t unset : {0, 1, 4}) EXPECT_EQ(now[unset].sigma_t, 0) << "not seen";
}

TEST(Live, SlidersAreFactorsAndTheScenesAlbedoIsForRowsWithoutTheirOwn) {
    Simulation simulation(liveScene());
    give(simulation, {command(changed(rowsAt({0, 1}, 2), [](ParticleRows& rows) { rows.extinctions[1] = 9000; }))});
    EXPECT_EQ(particlesOf(simulation)[0].albedo, glm::vec3(0.5f, 0.25f, 1));
    give(simulation, {command(Set{{"medium.extinction", 20.0f}, {"medium.albedo", glm::vec3(0.25f, 0.5f, 1)}})});
    EXPECT_EQ(particlesOf(simulation)[0].sigma_t, 1);
    EXPECT_EQ(particlesOf(simulation)[1].sigma_t, 1e4f) << "limits::kSigmaT";
    EXPECT_EQ(particlesOf(simulation)[0].albedo, glm::vec3(0.25f, 0.5f, 1));
}

TEST(Live, TheVolumeMovesThemAndAPushDoesNot) {
    Simulation simulation(liveScene()), calm(liveScene());
    for (Simulation* one : {&simulation, &calm}) give(*one, {command(rowsAt({1}, 1))});
    give(simulation, {command(Impulse{.origin = {1, 0, 9}})});
    calm.step({});
    EXPECT_EQ(simulation.stateHash(), calm.stateHash());
    give(simulation, {command(MoveVolume{.offset = {0, 2, 0}})});
    EXPECT_EQ(particlesOf(simulation)[0].centre, glm::vec3(1, 2, 0));
}

TEST(Live, PausedTheyStandStillAndMessagesAreTaken) {
    Simulation simulation(liveScene());
    give(simulation, {command(rowsAt({0}, 1))});
    give(simulation, {command(Set{{"simulation.paused", true}}), command(rowsAt({6}, 1, 0.1f))});
    simulation.step({});
    EXPECT_EQ(particlesOf(simulation)[0].centre.x, 0);
    give(simulation, {command(rowsAt({3}, 1))});
    EXPECT_EQ(particlesOf(simulation)[0].centre.x, 3) << "at once is at once";
}

TEST(Live, RestartForgetsAllOfThem) {
    Simulation simulation(liveScene()), fresh(liveScene());
    give(simulation, {command(rowsAt({0, 1, 2}, 3))});
    give(simulation, {command(rowsAt({5, 5, 5}, 3, 1))});
    give(simulation, {command(Restart{})});
    give(fresh, {command(Restart{})});
    EXPECT_EQ(simulation.liveCount(), 0u);
    EXPECT_EQ(simulation.stateHash(), fresh.stateHash());
    for (Simulation* one : {&simulation, &fresh}) give(*one, {command(rowsAt({7}, 3))});
    EXPECT_EQ(particlesOf(simulation)[1].sigma_t, 0);
    EXPECT_EQ(simulation.stateHash(), fresh.stateHash());
}

std::vector<Command> session(int tick) {
    if (tick % 10 == 0) return {command(rowsAt({float(tick), 1, 2}, 3, 0.2f)), command(rowsAt({9}, 3, 0.1f, 1))};
    if (tick == 35) return {command(MoveVolume{.offset = {1, 0, 0}}), command(rowsAt({}, 1))};
    return {};
}

TEST(Live, EqualMessagesGiveEqualHashesAndOthersDoNot) {
    Simulation a(liveScene()), b(liveScene());
    for (int tick = 1; tick <= 60; ++tick) {
        a.step(session(tick));
        b.step(session(tick));
        ASSERT_EQ(a.stateHash(), b.stateHash()) << tick;
    }
    const auto hash = [](const SetParticles& set, const SetParticles& then) {
        Simulation simulation(liveScene());
        give(simulation, {command(set), command(then)});
        return simulation.stateHash();
    };
    const SetParticles one = rowsAt({1, 2}, 2), nothing = rowsAt({}, 2);
    const uint64_t as_it_was = hash(one, nothing);
    EXPECT_NE(hash(rowsAt({1, 2.5f}, 2), nothing), as_it_was);
    EXPECT_NE(hash(one, rowsAt({}, 1)), as_it_was);
    EXPECT_NE(hash(one, rowsAt({1, 2}, 2, 1)), as_it_was) << "another way to the same place";
    EXPECT_NE(hash(changed(one, [](ParticleRows& rows) { rows.scales[1] = 3; }), nothing), as_it_was);
    EXPECT_NE(hash(changed(one, [](ParticleRows& rows) { rows.extinctions[1] = 3; }), nothing), as_it_was);
    EXPECT_NE(hash(changed(one, [](ParticleRows& rows) { rows.albedos.resize(2); }), nothing), as_it_was);
    EXPECT_NE(hash(one, rowsAt({4}, 2, 0, 5)), as_it_was) << "a row that is not there yet";
}

TEST(Live, StepAllocatesNothing) {
    Simulation simulation(liveScene());
    std::vector<std::vector<Command>> all;
    for (int tick = 1; tick <= 60; ++tick) all.push_back(session(tick));
    const size_t before = allocations();
    for (const auto& commands : all) simulation.step(commands);
    EXPECT_EQ(allocations(), before);
}

// What a recording could say, and the network refuses.
TEST(Live, MessagesBeyondTheirLimitsChangeNothing) {
    Simulation disturbed(liveScene()), calm(liveScene());
    const SetParticles good = rowsAt({1, 2}, 2);
    for (Simulation* one : {&disturbed, &calm}) give(*one, {command(good)});
    for (const SetParticles& bad :
         {rowsAt({1, 2}, 2, 0, 7), rowsAt({1}, 9), rowsAt({1}, 1, -1), rowsAt({1}, 1, kNaN), rowsAt({kNaN}, 1),
          rowsAt({1e6f}, 1), rowsAt({1}, 1, 0, ~0u), changed(good, [](ParticleRows& rows) { rows.scales[0] = 0; }),
          changed(good, [](ParticleRows& rows) { rows.extinctions[0] = 2e4f; }),
          changed(good,
                  [](ParticleRows& rows) {
                      rows.albedos = {glm::vec3(2), glm::vec3(0)};
                  }),
          changed(good, [](ParticleRows& rows) { rows.albedos = {glm::vec3(0)}; }),
          changed(good, [](ParticleRows& rows) { rows.scales.pop_back(); })}) {
        EXPECT_FALSE(problemOf(bad, 8).empty());
        EXPECT_EQ(problemOf(bad, 8).find('\n'), std::string::npos);
        give(disturbed, {command(bad)});
        calm.step({});
    }
    EXPECT_TRUE(problemOf(good, 8).empty());
    EXPECT_EQ(disturbed.stateHash(), calm.stateHash());
}

TEST(Live, OtherLayoutsTakeNoRows) {
    Simulation disturbed(cubeScene()), calm(cubeScene());
    give(disturbed, {command(rowsAt({1}, 1))});
    calm.step({});
    EXPECT_EQ(disturbed.stateHash(), calm.stateHash());
}

} // namespace
} // namespace brume::live_test

// For how long a picture shows the medium right.
#include <gtest/gtest.h>

#include "server/loop/medium_pace.h"
#include "tests/unit/simulation_scenes.h"

namespace brume {
namespace {

const Clock::time_point kNow = Clock::time_point{} + std::chrono::hours(1);

// ms, after half a second in which it was looked at.
double lastsMs(Simulation& simulation, MediumPace& pace) {
    for (int tick = 0; tick < 30; ++tick) {
        simulation.step({});
        pace.look(simulation);
    }
    return std::chrono::duration<double, std::milli>(pace.lasts(kNow)).count();
}
double lastsMs(Simulation& simulation) {
    MediumPace pace;
    return lastsMs(simulation, pace);
}

TEST(MediumPace, IsNotKnownAtFirst) {
    Simulation simulation(cubeScene());
    MediumPace pace;
    EXPECT_EQ(pace.lasts(kNow), Clock::duration{});
    pace.look(simulation);
    EXPECT_EQ(pace.lasts(kNow), Clock::duration{});
}

TEST(MediumPace, OfAMediumThatStandsIsLongest) {
    Simulation simulation(cubeScene());
    EXPECT_EQ(lastsMs(simulation), 200);
    Simulation plume(plumeScene());
    plume.step(std::vector{command(Set{{"simulation.paused", true}})});
    EXPECT_EQ(lastsMs(plume), 200);
}

TEST(MediumPace, OfAPlumeIsShort) {
    Simulation simulation(plumeScene());
    for (int tick = 0; tick < 300; ++tick) simulation.step({});
    EXPECT_LT(lastsMs(simulation), 100);
}

TEST(MediumPace, OfATurningSunIsByItsAngle) {
    Scene scene = cubeScene();
    scene.lights[0].rotate = 0.1f;
    Simulation simulation(scene);
    EXPECT_NEAR(lastsMs(simulation), 100, 1); // 0.01 rad
}

TEST(MediumPace, OfAnOrbitingLampIsByItsAngle) {
    Scene scene = cubeScene();
    scene.lights.push_back({.type = "point", .position = {2, 0, 0}, .orbit = 0.05f});
    Simulation simulation(scene);
    EXPECT_NEAR(lastsMs(simulation), 200, 1);
    scene.lights.back().orbit = -1;
    Simulation faster(scene);
    EXPECT_EQ(lastsMs(faster), 0) << "less than a tick";
}

TEST(MediumPace, OfAnEmptyMediumIsLongest) {
    Scene scene = plumeScene();
    scene.medium.emitter.rate = 0;
    Simulation simulation(scene);
    EXPECT_EQ(simulation.liveCount(), 0u);
    EXPECT_EQ(lastsMs(simulation), 200);
}

TEST(MediumPace, IsNotKnownForASecondAfterACommand) {
    Simulation simulation(cubeScene());
    MediumPace pace;
    ASSERT_EQ(lastsMs(simulation, pace), 200);
    pace.disturb(kNow);
    EXPECT_EQ(pace.lasts(kNow + std::chrono::milliseconds(900)), Clock::duration{});
    EXPECT_GT(pace.lasts(kNow + std::chrono::milliseconds(1100)), Clock::duration{});
}

} // namespace
} // namespace brume

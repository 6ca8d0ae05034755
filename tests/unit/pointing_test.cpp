// Where pointers' rays meet surfaces and the medium, against closed forms.
#include "server/loop/pointing.h"

#include <cmath>

#include <gtest/gtest.h>

#include "server/sim/obstacles.h"
#include "server/viewer/viewer.h"

namespace brume::pointing_test {
namespace {

constexpr float kFalloff = 1.6f;
const PointingRay kRay{{0, 0, 10}, {0, 0, -1}};

// A Gaussian whose whole line through the centre has this optical depth.
gpu::Particle ball(glm::vec3 centre, float depth, float scale = 1) {
    const float k = std::sqrt(50.0f) / (scale * kFalloff);
    return {centre, scale, glm::vec3(1), depth * k / std::sqrt(3.14159265f)};
}

Obstacles solidsOf(Scene scene) {
    Obstacles solids(scene);
    solids.follow(listsOf(scene), 1);
    return solids;
}
Scene withGround(float height) {
    Scene scene;
    scene.planes = {{.height = height}};
    return scene;
}

TEST(Pointing, FindsTheMiddleOfWhatIsHidden) {
    Pointing pointing;
    const Obstacles none = solidsOf({});
    // Half of what a thin ball hides lies before its centre.
    const auto thin = pointing.depthOf(kRay, none, std::vector{ball({0, 0, 0}, 0.05f)}, kFalloff);
    ASSERT_TRUE(thin);
    EXPECT_NEAR(*thin, 10, 0.02);
    // Of a dense one, 1 - exp(-x) = (1 - exp(-4)) / 2 is reached at x = 0.67496 of 4: there erf = -0.66252.
    const auto dense = pointing.depthOf(kRay, none, std::vector{ball({0, 0, 0}, 4)}, kFalloff);
    ASSERT_TRUE(dense);
    const double k = std::sqrt(50.0) / double(kFalloff);
    const double x = -std::log(1 - 0.5 * (1 - std::exp(-4.0)));
    double lo = -5, hi = 5;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (lo + hi);
        (2 * (1 + std::erf(middle)) < x ? lo : hi) = middle;
    }
    EXPECT_NEAR(*dense, 10 + lo / k, 0.011);
    EXPECT_LT(*dense, 9.95f);
}

TEST(Pointing, BesideAllThereIsNothing) {
    Pointing pointing;
    const Obstacles none = solidsOf({});
    EXPECT_FALSE(pointing.depthOf(kRay, none, {}, kFalloff));
    EXPECT_FALSE(pointing.depthOf(kRay, none, std::vector{ball({3, 0, 0}, 4)}, kFalloff)) << "it passes beside";
    EXPECT_FALSE(pointing.depthOf(kRay, none, std::vector{ball({0, 0, 20}, 4)}, kFalloff)) << "it lies behind";
    EXPECT_FALSE(pointing.depthOf(kRay, none, std::vector{ball({0, 0, 0}, 0.01f)}, kFalloff)) << "it hides nothing";
}

TEST(Pointing, TakesASurfaceUnlessTheMediumHidesIt) {
    Pointing pointing;
    const PointingRay down{{0, 10, 0}, {0, -1, 0}};
    const Obstacles ground = solidsOf(withGround(-2));
    const auto on = [&](float depth) {
        return pointing.depthOf(down, ground, std::vector{ball({0, 3, 0}, depth)}, kFalloff);
    };
    ASSERT_TRUE(on(0) && on(0.6f) && on(0.8f));
    EXPECT_NEAR(*on(0), 12, 1e-3);
    EXPECT_NEAR(*on(0.6f), 12, 1e-3) << "45 % are hidden";
    EXPECT_LT(*on(0.8f), 7.5f) << "55 % are hidden";
    // What lies behind the surface hides nothing.
    EXPECT_NEAR(pointing.depthOf(down, ground, std::vector{ball({0, -6, 0}, 9)}, kFalloff).value_or(0), 12, 1e-3);
}

TEST(Pointing, MeetsBoxesAndSpheres) {
    Pointing pointing;
    Scene scene;
    scene.boxes = {{.centre = {0, 0, 0}, .size = {2, 2, 2}}};
    scene.spheres = {{.centre = {5, 0, 0}, .radius = 1}};
    const Obstacles solids = solidsOf(scene);
    EXPECT_NEAR(pointing.depthOf(kRay, solids, {}, kFalloff).value_or(0), 9, 1e-4);
    EXPECT_NEAR(pointing.depthOf({{5, 0, 10}, {0, 0, -1}}, solids, {}, kFalloff).value_or(0), 9, 1e-4);
    EXPECT_FALSE(pointing.depthOf({{3, 0, 10}, {0, 0, -1}}, solids, {}, kFalloff));
}

TEST(Pointing, SurvivesExtremes) {
    Pointing pointing;
    const Obstacles none = solidsOf({});
    for (const float depth : {1e-30f, 1.0f, 1e20f, 1e30f})
        for (const float scale : {1e-6f, 1.0f, 1e4f}) {
            const auto metres = pointing.depthOf(kRay, none, std::vector{ball({0, 0, 0}, depth, scale)}, kFalloff);
            EXPECT_TRUE(!metres || std::isfinite(*metres)) << depth << " " << scale;
        }
}

TEST(Pointing, AnswersPeopleWhoseRaysMoved) {
    Pointing pointing;
    People people;
    const auto viewer = std::make_shared<Viewer>(1, PacingOptions{}, nullptr);
    people.join(viewer, "", 1);
    Scene scene = withGround(0);
    scene.medium.layout = Layout::none;
    const Simulation simulation(scene);
    pointing.follow(scene, simulation, people);
    EXPECT_FALSE(people.now().people.at(0).pointer);
    people.say(1, {.pointer = PointingRay{{2, 8, 3}, {0, -1, 0}}});
    pointing.follow(scene, simulation, people);
    const auto point = people.now().people.at(0).pointer;
    ASSERT_TRUE(point);
    EXPECT_NEAR(point->x, 2, 1e-4);
    EXPECT_NEAR(point->y, 0, 1e-3);
    EXPECT_NEAR(point->z, 3, 1e-4);
}

} // namespace
} // namespace brume::pointing_test

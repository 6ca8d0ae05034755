// What objects in the sun cost in the plan, and what one more would.
#include <gtest/gtest.h>

#include "server/plan/list_prices.h"
#include "tests/unit/plan_scenes.h"

namespace brume {
namespace {

// Haze in the sun from the right, and spheres in the middle of the picture: half as wide as it is high.
Scene shafts(uint32_t spheres) {
    Scene scene;
    scene.medium.layout = Layout::none;
    scene.fogs = {{.extinction = 0.03f}};
    scene.lights.emplace_back();
    scene.lights[0].to_light = {1, 0, 0};
    scene.camera = {.position = {0, 0, 10}, .target = {0, 0, 0}, .fov_y = 0.8f};
    scene.render.method = "slabs", scene.render.rate = 4, scene.render.slabs = 32;
    const Sphere sphere{.centre = {0, 0, 0}, .radius = 5 * std::tan(0.4f)};
    scene.spheres.assign(spheres, sphere);
    return scene;
}

double shadowsMet(const Scene& scene) {
    const PlanInputs inputs = inputsOf(scene);
    return ViewWork(inputs.scene, inputs.views[0]).shadowsMet();
}

ListPrices pricesOf(const Scene& scene) {
    const PlanInputs inputs = inputsOf(scene);
    return listPrices(inputs.scene, scene.render, inputs.views[0], builtInCosts(), 1000);
}

// A shadow goes from the middle to the left, over half of the rows.
TEST(CasterWork, IsTheMeanOfTheShadowsThatRaysMeet) {
    EXPECT_DOUBLE_EQ(shadowsMet(shafts(0)), 0);
    EXPECT_DOUBLE_EQ(shadowsMet(shafts(1)), 0.25);
    EXPECT_DOUBLE_EQ(shadowsMet(shafts(200)), 50) << "a sample stands for all";
}

TEST(CasterWork, IsThatOfShadowsInTheMedium) {
    Scene scene = shafts(1);
    scene.fogs.clear();
    scene.medium = cube().medium;
    EXPECT_GT(shadowsMet(scene), 0);
    scene.spheres[0].centre = {0, 100, 0};
    EXPECT_EQ(shadowsMet(scene), 0) << "above all that is seen";
    scene.spheres[0].centre = {0, 0, -100};
    EXPECT_EQ(shadowsMet(scene), 0) << "behind the medium";
}

TEST(CasterWork, NobodyAddsMoreObjectsThanThereIsTimeFor) {
    const ListPrices few = pricesOf(shafts(1)), many = pricesOf(shafts(400));
    EXPECT_GT(few.body, 0);
    EXPECT_GT(few.plane, 0);
    EXPECT_GT(many.body, 0);
    EXPECT_LT(many.body, few.body) << "surfaces cost no more beyond kMostCounted";
    EXPECT_LT(many.left, few.left);
    EXPECT_NEAR(many.growth, 7 * many.body, 1e-9) << "an eighth of the rays meets the shadow of such a box";
    Scene dark = shafts(400);
    dark.lights[0].irradiance = glm::vec3(0);
    EXPECT_LT(pricesOf(dark).body, 0.1 * many.body) << "no shafts";
    EXPECT_GT(pricesOf(dark).left, many.left);
}

} // namespace
} // namespace brume

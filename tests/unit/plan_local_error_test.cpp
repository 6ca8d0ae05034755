// What the plan predicts of the errors of points and spots among particles.
#include <cmath>

#include <gtest/gtest.h>

#include "server/methods/rays/ray_plan.h"
#include "server/plan/shown_lights.h"
#include "tests/unit/plan_scenes.h"

namespace brume {
namespace {

double square(double x) { return x * x; }

Light lampAt(glm::vec3 position) {
    Light light;
    light.type = kPoint;
    light.position = position;
    light.intensity = glm::vec3(1e4f);
    light.radius = 0.05f;
    return light;
}

// Many small particles, lit by one lamp and no sun.
Scene lit(glm::vec3 position, uint32_t count = 60) {
    Scene scene = cube(count, 6);
    scene.lights = {lampAt(position)};
    return scene;
}

struct Planned {
    PlanInputs inputs;
    ViewWork view;
    explicit Planned(const Scene& scene) : inputs(inputsOf(scene)), view(inputs.scene, inputs.views[0]) {}
    double error(uint32_t rate, uint32_t slabs) const { return localLightsError(view, rate, slabs); }
};

double partsOf(const ShownLights& shown) {
    double sum = 0;
    for (const ShownLights::Bend& bin : shown.bends()) sum += bin.part;
    for (const ShownLights::Core& core : shown.cores()) sum += core.part;
    return sum;
}

// A Gaussian of deviation 1 m, lit by a point `distance` m from its centre in a direction that makes `cosine` with the
// rays. Slabs hold their mean extinction. Error of all rays through it, root mean square over phases of the slabs.
double slabbedLight(double distance, double cosine, double thickness) {
    constexpr int kSteps = 1600, kPhases = 8;
    constexpr double kEnd = 8, kStep = 2 * kEnd / kSteps;
    const double along = distance * cosine, across = distance * std::sqrt(1 - cosine * cosine);
    double apart = 0, all = 0;
    for (double y = -2; y <= 2; y += 0.25) {
        const auto extinction = [&](double t) { return std::exp(-0.5 * (t * t + y * y)); };
        const auto light = [&](double t) { return 1 / (square(t - along) + square(y - across) + square(0.05)); };
        double exact = 0;
        for (int i = 0; i < kSteps; ++i) {
            const double t = -kEnd + (i + 0.5) * kStep;
            exact += extinction(t) * light(t) * kStep;
        }
        for (int phase = 0; phase < kPhases; ++phase) {
            double sum = 0, held = 0, arrived = 0; // of the present slab
            int count = 0, slab = 0;
            for (int i = 0; i < kSteps; ++i) {
                const double t = -kEnd + (i + 0.5) * kStep;
                const int own = int((t + kEnd) / thickness + double(phase) / kPhases);
                if (own != slab) sum += held * arrived / std::max(count, 1) * kStep, held = arrived = 0, count = 0;
                slab = own, held += extinction(t), arrived += light(t), ++count;
            }
            sum += held * arrived / std::max(count, 1) * kStep;
            apart += square(sum - exact), all += square(exact);
        }
    }
    return std::sqrt(apart / all);
}

TEST(LocalLightError, BoundsWhatSlabsLeaveOfAGaussian) {
    // None of the rays passes right by the light: that is its glow.
    for (const auto& [distance, cosine] : {std::pair(3.0, 0.0), std::pair(5.0, 0.0), std::pair(5.0, 0.7),
                                           std::pair(6.0, 1.0), std::pair(10.0, 0.7), std::pair(10.0, 1.0)})
        for (const double thickness : {0.25, 0.5, 1.0}) {
            const double bend = 1 / (square(distance - 1.5) + 1), found = slabbedLight(distance, cosine, thickness);
            EXPECT_LE(found, fallingLightError(thickness, bend)) << distance << ' ' << cosine << ' ' << thickness;
        }
    // It is no bound that holds for anything: with a tenth of the thickness it would break.
    EXPECT_GT(slabbedLight(5, 1, 1), fallingLightError(0.5, 1 / (square(3.5) + 1)));
}

TEST(LocalLightError, IsNothingWithoutLightsOrParticles) {
    EXPECT_EQ(Planned(cube(60)).error(8, 8), 0);
    Scene empty = lit({0, 0, 0});
    empty.medium.layout = Layout::none;
    EXPECT_EQ(Planned(empty).error(8, 8), 0);
}

TEST(LocalLightError, FallsWithSlabsAndRays) {
    const Planned inside(lit({0.5f, 0, 0.5f})), beside(lit({9, 0, 0}));
    for (const Planned* planned : {&inside, &beside}) {
        EXPECT_GT(planned->error(1, 8), 3 * planned->error(1, 32));
        EXPECT_GT(planned->error(16, 256), 1.5 * planned->error(1, 256));
    }
    EXPECT_GT(inside.error(1, 16), 1.5 * beside.error(1, 16)); // the nearer, the steeper
}

TEST(LocalLightError, HasTheVolumeWhateverTheSettings) {
    Scene scene = lit({20, 0, 0}, 400);
    scene.medium.scale = {0.8f, 0.8f};
    scene.medium.extinction = 4000;
    const double with = Planned(scene).error(1, 512);
    scene.lights[0].shadows = false; // nothing is looked up
    EXPECT_GT(with, 10 * Planned(scene).error(1, 512));
    EXPECT_EQ(Planned(scene).view.shownLights().directions(), 0);
}

TEST(LocalLightError, IsThatOfTheLocalPartOfTheLight) {
    Scene scene = lit({9, 0, 0});
    const double alone = Planned(scene).error(8, 16);
    scene.lights.push_back({.irradiance = glm::vec3(1000)});
    const double in_the_sun = Planned(scene).error(8, 16);
    EXPECT_GT(in_the_sun, 0);
    EXPECT_LT(in_the_sun, 0.3 * alone);
    scene.lights[1].irradiance = glm::vec3(0);
    EXPECT_DOUBLE_EQ(Planned(scene).error(8, 16), alone);
}

// Parts of a whole, however many lights there are. A few stand for all.
TEST(LocalLightError, TheBrightestStandForAll) {
    Scene scene = lit({9, 0, 0});
    EXPECT_NEAR(partsOf(Planned(scene).view.shownLights()), 1, 1e-9);
    const double one = Planned(scene).error(4, 24);
    for (int i = 0; i < 200; ++i) scene.lights.push_back(scene.lights.front());
    const Planned many(scene);
    EXPECT_NEAR(partsOf(many.view.shownLights()), 1, 1e-9);
    EXPECT_NEAR(many.error(4, 24), one, 0.01 * one);
}

// A lamp in the medium: the glow around it is most of the squared radiance.
TEST(LocalLightError, KnowsTheGlowOfALampInTheMedium) {
    const Planned inside(lit({0, 0, 0})), away(lit({60, 0, 0}));
    ASSERT_EQ(inside.view.shownLights().cores().size(), 1u);
    EXPECT_GT(inside.view.shownLights().cores()[0].part, 0.5);
    for (const ShownLights::Core& core : away.view.shownLights().cores()) EXPECT_LT(core.part, 1e-3);
}

TEST(LocalLightError, IsInTheMethodsError) {
    Scene scene = lit({0, 0, 0});
    scene.render.method = "slabs";
    const Planned planned(scene);
    RenderSettings settings;
    settings.method = "slabs", settings.rate = 4, settings.slabs = 16;
    const double error = planOf("slabs")->error(settings, planned.view).value();
    EXPECT_NEAR(square(error),
                square(planned.error(4, 16)) + square(raysError(planned.view, 4)) +
                    square(slabsError(planned.view, 16)) + square(2e-4),
                1e-9);
}

} // namespace
} // namespace brume

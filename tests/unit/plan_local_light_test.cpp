// What points and spots cost in the plan, and what overload gives up where they take the time.
#include <gtest/gtest.h>

#include "server/effects/local_lights/local_lights_plan.h"
#include "server/inputs/local_light_block.h"
#include "server/methods/rays/ray_plan.h"
#include "server/plan/cost_learning.h"
#include "tests/unit/plan_scenes.h"

namespace brume {
namespace {

Light point(glm::vec3 position, float range = 0) {
    Light light;
    light.type = kPoint;
    light.position = position;
    light.range = range;
    return light;
}

// Haze without particles, lit by points.
Scene haze(uint32_t lights) {
    Scene scene;
    scene.medium.layout = Layout::none;
    scene.fogs = {{.extinction = 0.03f}};
    scene.render.method = "slabs";
    scene.lights.clear();
    for (uint32_t i = 0; i < lights; ++i) scene.lights.push_back(point({float(i), 0, 0}));
    return scene;
}

Scene lamp() {
    Scene scene = cube(400, 6);
    scene.lights = {point({0, 0, 0})};
    scene.render.method = "slabs";
    return scene;
}

RenderSettings settingsOf(uint32_t rate, uint32_t slabs, uint32_t shading = kAuto) {
    RenderSettings settings;
    settings.method = "slabs", settings.rate = rate, settings.slabs = slabs, settings.shading = shading;
    return settings;
}

double workOf(const Scene& scene, const CostInfo& cost, const RenderSettings& settings, uint32_t width = 640) {
    const PlanInputs inputs = inputsOf(scene);
    return ViewWork(inputs.scene, {inputs.views[0].pose, width, width * 9 / 16}).of(settings)[cost];
}

TEST(LocalLightWork, GrowsWithLightsAndPixels) {
    const RenderSettings settings = settingsOf(4, 32);
    for (const CostInfo* cost : {&costs::kLocalLight, &costs::kLitSurfaces}) {
        const double one = workOf(haze(1), *cost, settings);
        EXPECT_GT(one, 0) << cost->key;
        EXPECT_DOUBLE_EQ(workOf(haze(8), *cost, settings), 8 * one) << cost->key;
        EXPECT_DOUBLE_EQ(workOf(haze(1), *cost, settings, 1280), 4 * one) << cost->key;
        EXPECT_EQ(workOf(haze(0), *cost, settings), 0) << cost->key;
    }
}

TEST(LocalLightWork, IsThatOfWhatARangeCovers) {
    Scene scene = haze(1);
    const double all = workOf(scene, costs::kLocalLight, settingsOf(4, 32));
    const glm::vec3 ahead = glm::normalize(scene.camera.target - scene.camera.position);
    scene.lights[0] = point(scene.camera.position + 20.0f * ahead, 2);
    const double some = workOf(scene, costs::kLocalLight, settingsOf(4, 32));
    EXPECT_GT(some, 0);
    EXPECT_LT(some, 0.2 * all);
    scene.lights[0].position = scene.camera.position - 20.0f * ahead;
    EXPECT_EQ(workOf(scene, costs::kLocalLight, settingsOf(4, 32)), 0);
}

TEST(LocalLightWork, FollowsSlabsAndTheStepOnlyWhereTheyMatter) {
    const auto work = [](const Scene& scene, const RenderSettings& s) { return workOf(scene, costs::kLocalLight, s); };
    EXPECT_EQ(work(haze(1), settingsOf(2, 64)), work(haze(1), settingsOf(8, 8)));
    EXPECT_GT(work(lamp(), settingsOf(4, 64)), 1.5 * work(lamp(), settingsOf(4, 32)));
    EXPECT_GT(work(lamp(), settingsOf(2, 32)), 2 * work(lamp(), settingsOf(4, 32)));
    EXPECT_GT(work(haze(1), settingsOf(4, 32, 1)), 2 * work(haze(1), settingsOf(4, 32, 4)));
}

TEST(LocalLightWork, ParticlesAreAddedToTheDepthOfEveryLightThatTheyDim) {
    Scene scene = lamp();
    const auto work = [&] { return sharedWork(inputsOf(scene).scene, settingsOf(4, 32))[costs::kLocalLightDepth]; };
    const double one = work();
    EXPECT_GE(one, 400 * 64 * 64) << "of all directions there are at least so many";
    EXPECT_LE(one, 400 * double(gpu::kMostLightSide) * gpu::kMostLightSide);
    RenderSettings coarse = settingsOf(4, 32);
    coarse.lamp_spacing = kCoarseLamps;
    EXPECT_LE(sharedWork(inputsOf(scene).scene, coarse)[costs::kLocalLightDepth], 0.7 * one);
    scene.lights.push_back(point({1, 0, 0}));
    const double two = work();
    EXPECT_GT(two, 1.5 * one);
    EXPECT_LE(two, 2 * one) << "together they are no finer than each alone";
    scene.lights[0].shadows = false;
    EXPECT_LE(work(), one);
    scene.lights[1].shadows = false;
    EXPECT_EQ(work(), 0);
}

// One particle of deviation 0.1 m at the origin.
float smoothLength(const Light& light, const SceneFeatures& features = {}, std::vector<Plane> planes = {}) {
    std::vector<gpu::LocalLight> lights{localLightBlock(light)};
    const std::vector<gpu::Particle> particles{{.centre = glm::vec3(0), .scale = 1, .sigma_t = 10}};
    const MediumExtent extent{.lo = glm::vec3(-0.3f), .hi = glm::vec3(0.3f), .deviation = 0.1f};
    setSmoothLengths(lights, particles, extent, 1, features, planes);
    return lights[0].smooth_length;
}

TEST(SmoothLength, IsTheDistanceToTheNearestParticle) {
    EXPECT_NEAR(smoothLength(point({3, 0, 0})), 2.9f, 1e-5f);
    EXPECT_NEAR(smoothLength(point({0.25f, 0, 0})), 0.15f, 1e-5f) << "in the bounds, beside the particle";
    EXPECT_EQ(smoothLength(point({0.05f, 0, 0})), 0) << "in the particle";
}

TEST(SmoothLength, OfASpotIsWhereItsConeFades) {
    Light spot = point({3, 0, 0});
    spot.type = kSpot, spot.axis = {-1, 0, 0}, spot.inner = 0.3f, spot.outer = 0.5f;
    EXPECT_NEAR(smoothLength(spot), 0.2f * 2.9f, 1e-4f);
    spot.inner = spot.outer - 1e-3f;
    EXPECT_LT(smoothLength(spot), 0.01f);
}

TEST(SmoothLength, IsNoneWhereObjectsOrFogMakeEdges) {
    Light light = point({3, 0, 0});
    EXPECT_EQ(smoothLength(light, {.fog = true}), 0);
    EXPECT_EQ(smoothLength(light, {.bodies = true}), 0);
    EXPECT_EQ(smoothLength(light, {.meshes = true}), 0);
    EXPECT_EQ(smoothLength(light, {}, {{1, {}}}), 0) << "a ground above the light hides it";
    EXPECT_GT(smoothLength(light, {}, {{-1, {}}}), 0);
    light.shadows = false;
    EXPECT_GT(smoothLength(light, {.bodies = true}), 0);
    EXPECT_EQ(smoothLength(light, {.fog = true}), 0);
}

// What rays hold no pixel looks up.
TEST(LampsOnRays, AreWorkOfRaysInPlaceOfPixels) {
    Scene scene = cube(400, 6);
    scene.render.method = "slabs";
    RenderSettings settings = settingsOf(4, 64);
    const auto pieces = [&] { return workOf(scene, costs::kLocalLight, settings); };
    const auto on_rays = [&] {
        const PlanInputs inputs = inputsOf(scene);
        return lampsOnRays(ViewWork(inputs.scene, inputs.views[0]), settings);
    };
    scene.lights = {point({0, 9, 0}), point({0, 0, 0})};
    const double both = pieces();
    EXPECT_EQ(on_rays(), 0) << "left open: pixels look up all";
    settings.lamp_spacing = kFineLamps;
    EXPECT_NEAR(pieces(), 0.5 * both, 0.1 * both) << "the lamp among the particles is left";
    EXPECT_GT(on_rays(), 0);
    scene.lights.pop_back();
    EXPECT_EQ(pieces(), 0);
    settings.rate = 16, settings.slabs = 8;
    EXPECT_GT(pieces(), 0) << "rays are too far apart";
}

// One fog without particles and without a ball is in closed form at every pixel.
TEST(FogWork, OneAloneHasNoRays) {
    Scene scene = haze(0);
    const auto work = [&](const char* method) {
        const PlanInputs inputs = inputsOf(scene);
        RenderSettings settings = settingsOf(4, 32);
        settings.method = method, settings.grid.spacing = 0.5f;
        const Work all = ViewWork(inputs.scene, inputs.views[0]).of(settings);
        double rays = 0;
        for (const CostInfo* cost : planOf(method)->costs())
            if (std::string_view(cost->pass).find("slab") == 0 || std::string_view(cost->pass) == "grid rays")
                rays += all[*cost];
        return rays;
    };
    for (const char* method : {"slabs", "grid"}) {
        EXPECT_EQ(work(method), 0) << method;
        scene.fogs[0].radius = 5;
        EXPECT_GT(work(method), 0) << method;
        scene.fogs[0].radius = 0;
        scene.fogs.push_back(scene.fogs[0]);
        EXPECT_GT(work(method), 0) << method;
        scene.fogs.pop_back();
    }
}

// All ways cost the same there by the costs of passes, but not the memory of a field with a ray for each pixel.
TEST(FogAlone, IsPlannedWithFewRaysThatNothingReads) {
    Scene scene = haze(0);
    scene.render.method = kAutoMethod;
    const auto chosen = [&] { return makePlan(inputsOf(scene), builtInCosts()).chosen.settings; };
    EXPECT_EQ(chosen().rate, kUnreadRate);
    EXPECT_EQ(chosen().slabs, kUnreadSlabs);
    scene.render.rate = 2, scene.render.slabs = 64;
    EXPECT_EQ(chosen().rate, 2u) << "who asks is obeyed";
    EXPECT_EQ(chosen().slabs, 64u);
}

// Where nearly all time is the lights', rays and slabs would be given up in vain: soft edges help alone.
TEST(LocalLightPlan, OverloadTakesNoStepThatDoesNotHelp) {
    const auto relaxed = [](uint32_t lights) {
        Scene scene = haze(lights);
        scene.fogs.push_back({.extinction = 0.01f}); // one alone has no rays
        PlanInputs inputs = inputsOf(scene);
        inputs.scene.wanted.rate = 2, inputs.scene.wanted.slabs = 64;
        inputs.relaxed = 10;
        const Plan plan = makePlan(inputs, builtInCosts());
        EXPECT_TRUE(plan.chosen.settings.soft_edges);
        return plan.relaxed;
    };
    EXPECT_GE(relaxed(1), 3u);
    EXPECT_EQ(relaxed(256), 1u);
}

TEST(LocalLightPlan, EveryOverloadStepAmongParticlesSavesTime) {
    PlanInputs inputs = inputsOf(lamp());
    inputs.scene.wanted.rate = 2, inputs.scene.wanted.slabs = 64;
    double last = makePlan(inputs, builtInCosts()).chosen.ms();
    for (inputs.relaxed = 1; inputs.relaxed < 20; ++inputs.relaxed) {
        const Plan plan = makePlan(inputs, builtInCosts());
        if (plan.relaxed < inputs.relaxed) break;
        EXPECT_LE(plan.chosen.ms(), 0.98 * last);
        last = plan.chosen.ms();
    }
    EXPECT_GT(inputs.relaxed, 2u);
    EXPECT_LT(inputs.relaxed, 20u);
}

// The surfaces' pass has two costs, which share what it takes.
TEST(LocalLightPlan, LearnsWhatLightsCost) {
    CostLearning learning(builtInCosts());
    const PlanInputs inputs = inputsOf(haze(4));
    const Work work = ViewWork(inputs.scene, inputs.views[0]).of(settingsOf(4, 32));
    const CostModel model = learning.first();
    const double local = work[costs::kLocalLight] * model[costs::kLocalLight] * 1e-6;
    const double surfaces =
        (work[costs::kLitSurfaces] * model[costs::kLitSurfaces] + work[costs::kOpaque] * model[costs::kOpaque]) * 1e-6;
    const PassMs took[] = {{"local light bins", 0.1 * local}, {"local light", 2.9 * local}, {"opaque", 0.5 * surfaces}};
    for (int i = 0; i < 60; ++i) learning.learn(work, took);
    EXPECT_NEAR(learning.model()[costs::kLocalLight] / model[costs::kLocalLight], 3, 0.05);
    EXPECT_NEAR(learning.model()[costs::kLitSurfaces] / model[costs::kLitSurfaces], 0.5, 0.02);
    EXPECT_NEAR(learning.model()[costs::kOpaque] / model[costs::kOpaque], 0.5, 0.02);
}

// Balls without particles have edges that rays smear. One fog alone is exact, and has no error to predict.
TEST(FogAlone, ItsErrorIsPredictedWhereItHasRays) {
    Scene scene = haze(0);
    const auto errorOf = [&](uint32_t rate) {
        const PlanInputs inputs = inputsOf(scene);
        return predictedError(inputs.scene, settingsOf(rate, 32), inputs.views[0]);
    };
    EXPECT_EQ(errorOf(8), 0);
    scene.fogs[0].radius = 3;
    EXPECT_GT(errorOf(8), 1.9 * errorOf(4));
    EXPECT_GT(errorOf(4), 1e-3);
    scene.render.method = kAutoMethod;
    const PlanInputs inputs = inputsOf(scene);
    const Plan plan = makePlan(inputs, builtInCosts());
    EXPECT_GT(plan.chosen.error, 0);
    EXPECT_LE(plan.chosen.error, double(scene.render.error));
}

// However many lights there are, their volumes fit what every device lets a shader see of a buffer.
TEST(LocalLightVolume, OfAllLightsFitABuffer) {
    const MediumExtent extent{.lo = glm::vec3(-4), .hi = glm::vec3(4), .deviation = 0.01f};
    for (const uint32_t particles : {1u, 100u, 100'000u})
        for (const uint32_t lights : {1u, 6u, 64u, 128u, 129u, 200u, 512u, 1024u}) {
            uint32_t numbers = 0;
            for (uint32_t i = 0; i < lights; ++i) {
                gpu::LocalLight block = localLightBlock({.type = kPoint, .position = {1, 0, 0}});
                numbers += setVolume(block, extent, particles, lights, numbers);
                EXPECT_GE(block.volume_side, 32u);
                EXPECT_GE(block.volume_shells, 24u);
            }
            EXPECT_LE(numbers * sizeof(float), size_t{128} << 20) << particles << ' ' << lights;
        }
}

// Few pairs of particles and lights have fine volumes. Many have no more numbers than 64x64x48, and a spot far fewer.
TEST(LocalLightVolume, IsAsFineAsTheWorkAllows) {
    const MediumExtent extent{.lo = glm::vec3(-4), .hi = glm::vec3(4), .deviation = 0.1f};
    const auto numbersOf = [&](const Light& light, uint32_t pairs, gpu::LocalLight& block) {
        block = localLightBlock(light);
        const uint32_t numbers = setVolume(block, extent, pairs, 1, 7);
        EXPECT_EQ(numbers, block.volume_side * block.volume_side * block.volume_shells);
        EXPECT_EQ(block.volume, 7u);
        EXPECT_EQ(block.volume_side % 16, 0u); // a workgroup does not cross the octahedron's folds
        return numbers;
    };
    Light light{.type = kPoint, .position = {1, 0, 0}, .range = 20};
    gpu::LocalLight block;
    EXPECT_EQ(numbersOf(light, 100, block), gpu::kMostLightSide * gpu::kMostLightSide * gpu::kMostLightShells);
    EXPECT_LT(block.volume_cosine, -1) << "inside: all directions";
    EXPECT_EQ(numbersOf(light, 100'000, block), 64u * 64 * 48);
    light.range = 2;
    EXPECT_EQ(numbersOf(light, 100'000, block), 64u * 64 * 16) << "the shells that were there before";
    EXPECT_NEAR(block.volume_near + block.volume_step * float(block.volume_shells - 1), 2, 1e-5);
    light.position = {30, 0, 0}, light.range = 0;
    numbersOf(light, 100'000, block);
    EXPECT_GT(block.volume_cosine, 0.95f) << "the cone around the particles";
    light.type = kSpot, light.axis = {-1, 0, 0}, light.inner = 0.05f, light.outer = 0.1f;
    EXPECT_LE(numbersOf(light, 100'000, block), 16u * 16 * 48);
    EXPECT_FLOAT_EQ(block.volume_cosine, block.cos_outer) << "its own cone is narrower";
}

} // namespace
} // namespace brume

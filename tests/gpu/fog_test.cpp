// Fog, drawn by the methods that draw it, against the double-precision reference: what it hides, what it scatters, with
// particles, objects and the eye in it, above it and below it.
#include <algorithm>
#include <cmath>

#include "tests/gpu/closed_form.h"
#include "tools/reference/camera.h"
#include "tools/reference/pixel.h"
#include "tools/reference/ray_tracer.h"

namespace brume::test {
namespace {

constexpr uint32_t kWidth = 160, kHeight = 90;
constexpr double kNear = 0.05;    // m, where pictures begin
constexpr uint32_t kEvery = 5;    // one pixel of so many is compared, across and down
constexpr double kAllowed = 5e-3; // relative RMSE

// With rays two pixels apart, where balls' edges are a large part of a small picture: what the plan predicts of edges,
// 0.5 * 2 / sqrt(pixels) (fogError() of server/methods/rays/ray_plan.h).
constexpr double kEdges = 8.4e-3;

class FogTest : public GpuTest {
protected:
    // A small cloud above the ground, lit from the side.
    static Scene cloudScene() {
        Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 0.35f), 1.6f);
        scene.lights[0].to_light = glm::normalize(glm::vec3(0.7f, 0.5f, 0.3f));
        scene.lights[0].irradiance = {12, 11, 9};
        scene.medium.anisotropy = 0.7f;
        scene.medium.asymmetry = 0.5f;
        scene.sky = {.zenith = {0.2f, 0.35f, 0.6f}, .horizon = {0.6f, 0.65f, 0.7f}};
        scene.render.rate = 2;
        scene.render.slabs = 128;
        scene.render.shadow_size = 256;
        scene.render.shadow_slices = 65;
        return scene;
    }
    static Scene withoutCloud() {
        Scene scene = cloudScene();
        scene.medium.layout = Layout::none;
        return scene;
    }

    struct Error {
        double rmse, worst; // of total radiance; relative to its RMS
    };
    static Error errorOf(const Scene& scene, const Pose& pose) {
        const Picture picture = render(device(), scene, pose, kWidth, kHeight);
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        const SceneNow& now = simulation.now();
        const reference::World world = reference::worldOf(scene, particles, now.medium, now.light, now.fogs);
        const reference::Stage stage(world, {.tolerance = 1e-5});
        reference::RayTracer tracer(stage);
        const reference::Camera camera = reference::perspective(pose, kWidth, kHeight, kNear);
        double errors = 0, values = 0, worst = 0;
        int count = 0;
        for (uint32_t y = kEvery / 2; y < kHeight; y += kEvery)
            for (uint32_t x = kEvery / 2; x < kWidth; x += kEvery) {
                const auto at = [&](double dx, double dy) {
                    return tracer.trace(reference::rayThrough(camera, x + dx, y + dy));
                };
                const reference::PixelResult truth = reference::pixelOf(at, !world.obstacles.empty());
                if (truth.edge) continue;
                const glm::dvec4 got(picture.at(x, y));
                const glm::dvec3 off = glm::dvec3(got) - truth.total;
                EXPECT_TRUE(std::isfinite(got.x + got.y + got.z + got.w)) << x << ' ' << y;
                errors += glm::dot(off, off), values += glm::dot(truth.total, truth.total), ++count;
                worst = std::max(worst, glm::length(off));
            }
        EXPECT_GT(count, 300);
        return {std::sqrt(errors / values), worst / std::sqrt(values / count)};
    }

    // Judges slabs and grid from several places.
    static void judge(Scene scene, std::initializer_list<Pose> poses, double allowed = kAllowed) {
        for (const char* method : {"slabs", "grid"}) {
            scene.render.method = method;
            scene.render.grid.spacing = 0.5f;
            int number = 0;
            for (const Pose& pose : poses) {
                const Error error = errorOf(scene, pose);
                std::printf("%-6s view %d: %.4f %%, worst pixel %.3f %%\n", method, number, 100 * error.rmse,
                            100 * error.worst);
                EXPECT_LE(error.rmse, allowed) << method << ", view " << number;
                ++number;
            }
        }
    }
};

const Pose kOutside = lookAt({2, 3, 14}, {0, 0, 0}, 0.9f), kInside = lookAt({0.5f, 0.3f, 1}, {0, 0, -5}, 1.0f),
           kBelow = lookAt({3, -3.5f, 9}, {0, 1, 0}, 0.9f), kAbove = lookAt({4, 25, 18}, {0, 0, 0}, 0.2f),
           kHorizon = lookAt({0, 2, 14}, {0, 2.2f, -1000}, 1.2f);

TEST_F(FogTest, Homogeneous) {
    Scene scene = cloudScene();
    scene.fogs = {{.extinction = 0.05f, .albedo = {0.9f, 0.8f, 0.7f}}};
    scene.fogs[0].hi = 30; // light reaches it
    judge(scene, {kOutside, kInside, kAbove});
}

TEST_F(FogTest, HeightFog) {
    Scene scene = cloudScene();
    scene.fogs = {{.extinction = 0.08f, .height = -2, .falloff = 0.3f, .albedo = {0.95f, 0.95f, 0.9f}}};
    scene.fogs[0].phase = "droplets";
    judge(scene, {kOutside, kInside, kBelow, kAbove, kHorizon});
}

TEST_F(FogTest, OverTheGroundToTheHorizon) {
    Scene scene = cloudScene();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.fogs = {{.extinction = 0.05f, .height = -4, .falloff = 0.2f}};
    judge(scene, {kOutside, kInside, kBelow, kAbove, kHorizon});
}

TEST_F(FogTest, ALayerOnTheGround) {
    Scene scene = cloudScene();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.fogs = {{.extinction = 0.4f, .hi = -2.5f}};
    judge(scene, {kOutside, kBelow, kAbove, kHorizon});
}

TEST_F(FogTest, ABallAroundAndABallBeside) {
    Scene scene = cloudScene();
    scene.fogs = {{.extinction = 0.2f, .centre = {-1, 0, 1}, .radius = 3},
                  {.extinction = 2, .centre = {4, 2, -3}, .radius = 1.5f, .albedo = {0.9f, 0.4f, 0.2f}}};
    judge(scene, {kOutside, kInside, kBelow}, kEdges);
}

TEST_F(FogTest, FogsOfDifferentPhaseThatEmit) {
    Scene scene = cloudScene();
    scene.sky.ambient = {0.1f, 0.15f, 0.2f};
    scene.fogs = {
        {.extinction = 0.04f, .falloff = 0.1f},
        {.extinction = 0.5f, .centre = {3, 0, 0}, .radius = 2, .albedo = {0.5f, 0.5f, 0.5f}, .emission = {3, 1, 0}}};
    scene.fogs[0].anisotropy = 1;
    scene.fogs[0].asymmetry = 0.7f;
    judge(scene, {kOutside, kInside, kBelow});
}

TEST_F(FogTest, ShaftsOfObjects) {
    Scene scene = cloudScene();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.boxes = {{{5, -1, 0}, {1, 6, 3}, 0.4f, glm::vec3(0.6f)}, {{-4, -3, 3}, {2, 2, 2}, 0, glm::vec3(0.3f)}};
    scene.spheres = {{{2, 4, 1}, 1.2f, glm::vec3(0.5f)}};
    scene.fogs = {{.extinction = 0.05f, .height = -4, .falloff = 0.1f}};
    judge(scene, {kOutside, kBelow, kAbove});
}

TEST_F(FogTest, WithoutParticles) {
    Scene scene = withoutCloud();
    scene.fogs = {{.extinction = 0.05f, .height = -2, .falloff = 0.3f},
                  {.extinction = 0.5f, .centre = {3, 0, 0}, .radius = 2, .albedo = {0.5f, 0.5f, 0.5f}}};
    judge(scene, {kOutside, kInside, kBelow, kHorizon});
}

// One that is lit past itself needs no slabs, and two are exact, too, where their extinctions fall at different rates.
TEST_F(FogTest, HeightFogsAlone) {
    Scene scene = withoutCloud();
    scene.fogs = {{.extinction = 0.05f, .height = -2, .falloff = 0.3f}};
    judge(scene, {kOutside, kInside, kBelow, kHorizon}, 2e-4);
    scene.fogs.push_back({.extinction = 0.05f, .height = -2, .falloff = 0.2f});
    judge(scene, {kOutside, kInside, kBelow, kHorizon}, 2e-4);
}

TEST_F(FogTest, OtherMethodsRefuseIt) {
    Scene scene = cloudScene();
    scene.fogs.emplace_back();
    for (const char* method : {"tiles", "sphere", "isv"}) {
        scene.render.method = method;
        try {
            render(device(), scene, kOutside, kWidth, kHeight);
            ADD_FAILURE() << method << " drew it";
        } catch (const gpu::Error& error) {
            EXPECT_EQ(error.what(), method + std::string(": it draws no fog; use slabs or grid"));
        }
    }
}

// A room with an opening: nearly all of every ray is in shadow, whose boundaries lie far apart.
TEST_F(FogTest, LightThroughAWindow) {
    Scene scene = withoutCloud();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    const glm::vec3 grey(0.5f);
    scene.boxes = {{{0, 3, 0}, {17, 0.4f, 17}, 0, grey},      {{0, -0.5f, -8}, {17, 7, 0.4f}, 0, grey},
                   {{-8, -0.5f, 0}, {0.4f, 7, 17}, 0, grey},  {{8, -3, 0}, {0.4f, 2, 17}, 0, grey},
                   {{8, 2, 0}, {0.4f, 2, 17}, 0, grey},       {{8, -0.5f, -5}, {0.4f, 3, 7}, 0, grey},
                   {{8, -0.5f, 5.5f}, {0.4f, 3, 6}, 0, grey}, {{0, -0.5f, 8}, {17, 7, 0.4f}, 0, grey}};
    scene.fogs = {{.extinction = 0.05f, .hi = 3}};
    judge(scene, {lookAt({-6, 1, 6}, {3, -2, -3}, 1.0f)});
}

} // namespace
} // namespace brume::test

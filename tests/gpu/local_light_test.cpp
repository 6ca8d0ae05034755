// Points and spots against the double-precision reference: in fog, on surfaces, past objects, among particles.
#include <gtest/gtest.h>

#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::local_light_test {
namespace {

constexpr double kAmongParticles = 1e-2;

class LocalLightTest : public JudgedTest {
protected:
    // Dark, but for local lights.
    static Scene emptyScene() {
        Scene scene;
        scene.medium.layout = Layout::none;
        scene.lights.clear();
        scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
        scene.render.rate = 2;
        scene.render.slabs = 128;
        return scene;
    }
    static Scene foggyScene() {
        Scene scene = emptyScene();
        scene.fogs = {{.extinction = 0.05f, .albedo = {0.9f, 0.8f, 0.7f}}};
        scene.fogs[0].anisotropy = 0.8f;
        scene.fogs[0].asymmetry = 0.6f;
        return scene;
    }
    static Light point(glm::vec3 position) { return {.type = kPoint, .position = position, .intensity = {90, 80, 60}}; }
    static Light spot(glm::vec3 position, glm::vec3 axis) {
        Light light = point(position);
        light.type = kSpot;
        light.axis = glm::normalize(axis);
        return light;
    }
};

const Pose kOutside = lookAt({2, 3, 14}, {0, 0, 0}, 0.9f), kInside = lookAt({0.5f, 0.3f, 1}, {0, 0, -5}, 1.0f),
           kBelow = lookAt({3, -3.5f, 9}, {0, 1, 0}, 0.9f);

TEST_F(LocalLightTest, APointInFog) {
    Scene scene = foggyScene();
    scene.lights = {point({1, 1, 0})};
    judge(scene, {kOutside, kInside, kBelow});
    scene.lights[0].range = 6;
    scene.lights[0].radius = 0.3f;
    judge(scene, {kOutside, kInside});
}

TEST_F(LocalLightTest, SpotsOfSeveralWidths) {
    Scene scene = foggyScene();
    scene.lights = {spot({-3, 5, 0}, {0.3f, -1, 0}), spot({4, 4, -2}, {-1, -0.5f, 0.2f}), spot({0, 1, 6}, {0, 0, -1})};
    scene.lights[0].inner = 0.05f, scene.lights[0].outer = 0.1f;
    scene.lights[1].inner = 1.2f, scene.lights[1].outer = 1.4f;
    scene.lights[2].inner = 0.2f, scene.lights[2].outer = 0.8f, scene.lights[2].range = 12;
    judge(scene, {kOutside, kInside, kBelow});
}

TEST_F(LocalLightTest, OverTheGroundPastObjects) {
    Scene scene = foggyScene();
    scene.fogs[0].height = -4, scene.fogs[0].falloff = 0.2f;
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.boxes = {{{2, -1, 0}, {1, 6, 1}, 0.4f, glm::vec3(0.6f)}, {{-4, -3, 3}, {2, 2, 2}, 0, glm::vec3(0.3f)}};
    scene.spheres = {{{-1, 1, 1}, 0.8f, glm::vec3(0.5f)}};
    scene.lights = {point({0.5f, 2.5f, 2}), spot({-5, 4, -1}, {1, -0.7f, 0.3f})};
    judge(scene, {kOutside, kInside, kBelow});
}

// The ground hides a light below it from all places above it, as its surface is seen from above only.
TEST_F(LocalLightTest, BelowTheGround) {
    Scene scene = foggyScene();
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.lights = {point({1, -5, 0}), point({-3, 2, 0})};
    judge(scene, {kOutside, lookAt({3, -6, 9}, {0, -3, 0}, 0.9f)});
    scene.lights[0].shadows = false;
    judge(scene, {kOutside});
}

TEST_F(LocalLightTest, AmongParticles) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = sceneOf(randomPoints(60, 5, 1.6f, 0.35f), 1.6f);
    scene.lights.clear();
    scene.medium.anisotropy = 0.7f;
    scene.medium.asymmetry = 0.5f;
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
    scene.render.rate = 1; // the light of near particles is seen alone
    scene.render.slabs = 128;
    scene.lights = {point({4, 3, 2})};
    judge(scene, {kOutside, kBelow}, kAmongParticles);
    scene.lights = {point({0.2f, 0.3f, -0.2f})};
    judge(scene, {kOutside, kInside, kBelow}, kAmongParticles);
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.fogs = {{.extinction = 0.05f, .height = -4, .falloff = 0.2f}};
    scene.lights.push_back(spot({-5, 4, -1}, {1, -0.7f, 0.3f}));
    judge(scene, {kOutside, kBelow}, kAmongParticles);
}

// Slabs two thirds of a deviation thick, of particles among which light falls much within one. Taken as even within
// slabs, extinction errs by a twelfth of the light's relative bend, 6 / d^2, times the squared thickness: up to 2.8 %.
TEST_F(LocalLightTest, FallsWithinThickSlabs) {
    Scene scene = sceneOf({{.centre = {0, 0, 0}, .scale = 8, .sigma_t = 0.3f},
                           {.centre = {1.5f, 0.5f, -1}, .scale = 9, .sigma_t = 0.2f}});
    scene.lights.clear();
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
    scene.render.rate = 1;
    scene.render.slabs = 16;
    scene.render.grid.spacing = 0.25f;
    scene.lights = {point({2.5f, 2.5f, 2})};
    judge(scene, {kOutside, kBelow});
    scene.lights = {point({-2, -2.8f, 2})};
    judge(scene, {kOutside, kBelow, kInside});
    scene.fogs = {{.extinction = 0.02f, .albedo = {0.9f, 0.8f, 0.7f}}};
    judge(scene, {kOutside, kInside});
}

// Particles that are small beside their distance from a light: 0.2 of 8 m. Directions over the whole sphere would be
// more than two deviations apart.
TEST_F(LocalLightTest, SmallParticlesFarAway) {
    Scene scene = sceneOf(randomPoints(200, 4, 1.2f, 3), 1.6f);
    scene.lights.clear();
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
    scene.render.rate = 1;
    scene.render.slabs = 128;
    scene.render.grid.spacing = 0.25f;
    scene.lights = {point({5, 5, 4})};
    judge(scene, {kOutside}, kAmongParticles);
    scene.lights = {spot({-5, 5, 4}, {1, -1, -0.8f})};
    scene.lights[0].inner = 0.2f, scene.lights[0].outer = 0.4f;
    judge(scene, {kOutside}, kAmongParticles);
}

// Relative RMSE of two pictures.
double difference(const Picture& a, const Picture& b) {
    double errors = 0, values = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        const glm::dvec3 x(a.pixels[i]), y(b.pixels[i]);
        errors += glm::dot(x - y, x - y), values += glm::dot(y, y);
    }
    return std::sqrt(errors / values);
}

// Rays hold light that varies little between them: of lamps outside, and as exact as by pixels.
TEST_F(LocalLightTest, OnRays) {
    Scene scene = sceneOf(randomPoints(40, 5, 1.6f, 0.35f), 1.6f);
    scene.lights.clear();
    scene.medium.anisotropy = 0.7f;
    scene.medium.asymmetry = 0.5f;
    scene.medium.albedo = {0.9f, 0.6f, 0.3f};
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.render.rate = 1;
    scene.render.slabs = 128;
    scene.render.grid.spacing = 0.25f;
    scene.lights = {point({5, 4, 3}), spot({-6, 5, -1}, {1, -0.7f, 0.3f}), point({0, 6, -4})};
    scene.lights[1].inner = 0.2f, scene.lights[1].outer = 0.6f;
    for (const char* method : {"slabs", "grid"}) {
        scene.render.method = method;
        Scene by_pixels = scene;
        scene.render.lamp_spacing = 0.25f;
        Stage on_rays(device(), scene, 64), other(device(), by_pixels, 64);
        for (const Pose& pose : {kOutside, kBelow}) {
            const double off =
                difference(on_rays.see(scene, pose, kWidth, kHeight), other.see(by_pixels, pose, kWidth, kHeight));
            std::printf("%-6s on rays and by pixels: %.4f %%\n", method, 100 * off);
            EXPECT_LT(off, 5e-3);
            EXPECT_GT(off, 1e-7) << "rays hold it";
        }
        scene.render.lamp_spacing = kAuto;
    }
    scene.render.lamp_spacing = 0.25f;
    judge(scene, {kOutside, kBelow}, kAmongParticles);
}

// A lamp among particles is left to pixels, whatever the rest.
TEST_F(LocalLightTest, AmongParticlesIsOnNoRay) {
    Scene scene = sceneOf(randomPoints(40, 5, 1.6f, 0.35f), 1.6f);
    scene.lights = {point({0, 0, 0})};
    scene.render.rate = 4, scene.render.slabs = 32;
    scene.render.lamp_spacing = kAuto;
    Simulation simulation(scene);
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    scene.lights[0].position = particles[0].centre;
    scene.render.method = "slabs";
    Scene on_rays = scene;
    on_rays.render.lamp_spacing = 10;
    Stage a(device(), scene, 64), b(device(), on_rays, 64);
    EXPECT_EQ(difference(a.see(scene, kOutside, kWidth, kHeight), b.see(on_rays, kOutside, kWidth, kHeight)), 0);
}

// Edges of shafts, of cones and of what surfaces cut off are smoothed over some pixels, lights' images are not.
TEST_F(LocalLightTest, SoftEdges) {
    Scene scene = foggyScene();
    scene.fogs[0].height = -4, scene.fogs[0].falloff = 0.2f;
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    scene.boxes = {{{2, -1, 0}, {1, 6, 1}, 0.4f, glm::vec3(0.6f)}, {{-4, -3, 3}, {2, 2, 2}, 0, glm::vec3(0.3f)}};
    scene.spheres = {{{-1, 1, 1}, 0.8f, glm::vec3(0.5f)}};
    Light sun;
    sun.to_light = glm::normalize(glm::vec3(0.5f, 1, 0.2f));
    scene.lights = {sun, point({0.5f, 2.5f, 2}), spot({-5, 4, -1}, {1, -0.7f, 0.3f})};
    scene.render.rate = 4, scene.render.method = "slabs";
    Scene soft = scene;
    soft.render.soft_edges = true;
    Stage a(device(), scene, 1), b(device(), soft, 1);
    for (const Pose& pose : {kOutside, kInside, kBelow}) {
        const Picture sharp = a.see(scene, pose, 2 * kWidth, 2 * kHeight);
        const Picture smooth = b.see(soft, pose, 2 * kWidth, 2 * kHeight);
        const double off = difference(smooth, sharp);
        std::printf("soft edges: %.4f %%\n", 100 * off);
        EXPECT_LT(off, 0.015);
        EXPECT_GT(off, 1e-7);
        EXPECT_EQ(glm::any(glm::isnan(smooth.at(0, 0))), false);
    }
}

} // namespace
} // namespace brume::test::local_light_test

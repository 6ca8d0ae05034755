// Light that particles emit, by every method, against closed forms and the reference.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/gpu/fixture.h"
#include "tests/gpu/truth.h"
#include "tools/reference/camera.h"
#include "tools/reference/world.h"

namespace brume::test::emission_test {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 48;
const glm::vec3 kAlbedo{0.25f, 0.5f, 1};
const Pose kOutside = lookAt({0, 2, 20}, {0, 0, 0}, 0.7f), kInside = lookAt({1, 0, 2}, {-1, 0, 0}, 1.5f);

class EmissionTest : public GpuTest {
protected:
    static std::vector<const char*> methods() {
        return {"sphere", "isv", "tiles", "slabs", "grid", "march", "froxels", "lit", "gradients"};
    }
    static bool drawsFog(const std::string& method) {
        return method != "sphere" && method != "isv" && method != "tiles";
    }
    // Particles of all albedos.
    static Scene mixed() {
        std::vector<Point> points = randomPoints(200, 8, 3, 1.5f);
        Random random(4);
        for (Point& p : points) p.albedo = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
        Scene scene = sceneOf(points, 1.6f);
        scene.lights.clear();
        scene.render.shadow_size = 32;
        scene.render.froxels.pixels = 1; // cells of more are too coarse for these pictures
        return scene;
    }
};

// What scatters a light of 1 from everywhere, and emits what it does not scatter, is as bright as the sky behind it,
// whatever its albedos are.
TEST_F(EmissionTest, SootAsBrightAsTheSkyCannotBeSeen) {
    for (const bool fog : {false, true}) {
        Scene scene = mixed();
        scene.sky = {.zenith = glm::vec3(1), .horizon = glm::vec3(1), .ambient = glm::vec3(1)};
        scene.medium.emission = glm::vec3(1);
        if (fog) scene.fogs = {{.extinction = 0.02f, .albedo = {0.9f, 0.5f, 0}, .emission = glm::vec3(1)}};
        for (const char* method : some(methods())) {
            if (fog && !drawsFog(method)) continue;
            scene.render.method = method;
            for (const Pose& pose : {kOutside, kInside}) {
                const Picture picture = render(device(), scene, pose, kWidth, kHeight);
                float off = 0, through = 1;
                for (const glm::vec4& pixel : picture.pixels) {
                    through = std::min(through, pixel.a);
                    for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(pixel[c] - 1));
                }
                std::printf("%s%s: %.1e\n", method, fog ? " with fog" : "", double(off));
                EXPECT_LE(off, 2e-5f) << method;
                EXPECT_LT(through, 0.3f) << method;
            }
        }
    }
}

// Without any other light, of one albedo: (1 - albedo) E (1 - T), as a medium of one temperature.
TEST_F(EmissionTest, EmitsByWhatItHides) {
    std::vector<Point> points = randomPoints(200, 8, 3, 1.5f);
    for (Point& p : points) p.albedo = kAlbedo;
    Scene scene = sceneOf(points, 1.6f);
    scene.lights.clear();
    scene.render.froxels.pixels = 1;
    scene.medium.emission = {3, 2, 5};
    for (const char* method : some(methods())) {
        scene.render.method = method;
        const Picture picture = render(device(), scene, kOutside, kWidth, kHeight);
        double off = 0;
        for (const glm::vec4& pixel : picture.pixels)
            for (int c = 0; c < 3; ++c) {
                const double emitted = (1 - double(kAlbedo[c])) * double(scene.medium.emission[c]);
                off = std::max(off, std::abs(double(pixel[c]) - emitted * (1 - double(pixel.a))));
            }
        std::printf("%s: %.1e\n", method, off);
        EXPECT_LE(off, 2e-5) << method;
    }
}

// The union of balls and tetrahedra emit as well.
TEST_F(EmissionTest, OtherMediaDoToo) {
    Scene scene = sceneOf({{{-2, 0, 0}, 2, 1, kAlbedo},
                           {{2, 0, 1}, 2, 1, kAlbedo},
                           {{0, 3, 0}, 2, 2, kAlbedo},
                           {{0, 0, -3}, 2, 0.5f, kAlbedo}},
                          1.6f, {{0, 1, 2, 3}});
    scene.lights.clear();
    scene.medium.emission = {3, 2, 5};
    Scene balls = sceneOf({{{0, 0, 0}, 20, 1, kAlbedo}}, 1.6f);
    balls.lights.clear();
    balls.medium.model = kUnionMedium;
    balls.medium.albedo = kAlbedo;
    balls.medium.emission = scene.medium.emission;
    for (Scene* one : {&scene, &balls}) {
        one->render.method = one == &scene ? "tetrahedra" : "sprites";
        const Picture picture = render(device(), *one, kOutside, kWidth, kHeight);
        double off = 0, through = 1;
        for (const glm::vec4& pixel : picture.pixels) {
            through = std::min(through, double(pixel.a));
            for (int c = 0; c < 3; ++c) {
                const double emitted = (1 - double(kAlbedo[c])) * double(one->medium.emission[c]);
                off = std::max(off, std::abs(double(pixel[c]) - emitted * (1 - double(pixel.a))));
            }
        }
        EXPECT_LE(off, 2e-5) << one->render.method;
        EXPECT_LT(through, 0.7) << one->render.method;
    }
}

// --- with fluxes, what is emitted scatters in the medium

Scene among(const std::vector<Point>& points) {
    Scene scene = sceneOf(points, 1.6f);
    scene.lights.clear();
    scene.render.method = "slabs";
    scene.render.rate = 1;
    scene.render.slabs = 64;
    scene.render.scattering = "propagation";
    return scene;
}

// Of one temperature with the sky, a medium that absorbs is as little seen as one that scatters all.
TEST_F(EmissionTest, AnEvenTemperatureStaysAsItIsInTheFluxes) {
    for (const float sigma_t : {0.05f, 0.5f, 5.0f}) {
        std::vector<Point> points = randomPoints(60, 4, 6, sigma_t);
        for (Point& p : points) p.albedo = {0.25f, 0.5f, 0.9f};
        Scene scene = among(points);
        scene.sky.zenith = scene.sky.horizon = scene.medium.emission = {1, 2, 3};
        scene.sky.lights = true;
        const Picture picture = render(device(), scene, lookAt({3, 2, 11}, {0, 0, 0}, 0.7f), 48, 27);
        double off = 0;
        for (const glm::vec4& pixel : picture.pixels)
            for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(double(pixel[c]) / (1 + c) - 1));
        std::printf("even temperature, extinction %g: %.1e\n", double(sigma_t), off);
        EXPECT_LT(off, 1e-4) << sigma_t;
    }
}

// Soot in the middle of smoke lights it: beside random paths, which know all orders of scattering.
TEST_F(EmissionTest, SootLightsSmokeAsRandomPathsDo) {
    struct Case {
        const char* name;
        float sigma_t;
        double rmse; // allowed: one and a half times the measured one
        float sun = 0;
    };
    for (const Case& c : {Case{"thin smoke", 0.05f, 0.042}, Case{"smoke", 0.3f, 0.032},
                          Case{"dense smoke", 1.5f, 0.081}, Case{"dark soot in sunlit smoke", 0.3f, 0.036, 10}}) {
        std::vector<Point> points = randomPoints(80, 5, 5, c.sigma_t);
        for (Point& p : points)
            p.albedo = glm::length(p.centre - glm::vec3(1, 0, 0)) < 1.8f ? glm::vec3(0.1f) : glm::vec3(1, 0.9f, 0.8f);
        Scene scene = among(points);
        if (c.sun > 0)
            scene.lights = {{.irradiance = glm::vec3(c.sun)}};
        else
            scene.medium.emission = {9, 4, 1};
        const Pose from = lookAt({3, 2, 11}, {0, 0, 0}, 0.7f);
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        const reference::TrackedPicture truth =
            truePaths(reference::worldOf(scene, particles), reference::perspective(from, 48, 27), 96);
        const auto errorOf = [&](const Picture& picture) {
            double errors = 0, noise = 0, squares = 0;
            for (size_t i = 0; i < truth.radiance.size(); ++i) {
                const glm::dvec3 off = glm::dvec3(picture.pixels[i]) - truth.radiance[i];
                errors += glm::dot(off, off), squares += glm::dot(truth.radiance[i], truth.radiance[i]);
                noise += glm::dot(truth.standard_error[i], truth.standard_error[i]);
            }
            return std::sqrt(std::max(errors - noise, 0.0) / squares);
        };
        const double fluxes = errorOf(render(device(), scene, from, 48, 27));
        scene.render.scattering = "single";
        const double single = errorOf(render(device(), scene, from, 48, 27));
        std::printf("%s: fluxes err by %.1f %%, single scattering by %.1f %%\n", c.name, 100 * fluxes, 100 * single);
        EXPECT_LT(fluxes, c.rmse) << c.name;
        EXPECT_LT(5 * fluxes, single) << c.name;
    }
}

} // namespace
} // namespace brume::test::emission_test

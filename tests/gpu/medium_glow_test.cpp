// Light that the medium throws on surfaces (render.propagation.onto_surfaces): a closed form, and random paths.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/sim/simulation.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/fixture.h"
#include "tests/gpu/truth.h"
#include "tests/layer.h"
#include "tools/reference/camera.h"
#include "tools/reference/world.h"

namespace brume::test::medium_glow_test {
namespace {

constexpr uint32_t kWidth = 32, kHeight = 18;
constexpr int kPaths = 512;

class MediumGlowTest : public GpuTest {
protected:
    static Scene over(const std::vector<Point>& points, float ground) {
        Scene scene = sceneOf(points, 1.6f);
        scene.lights.clear();
        scene.planes = {{.height = ground, .albedo = glm::vec3(0.5f, 1, 0.8f)}};
        scene.render.method = "slabs";
        scene.render.rate = 1;
        scene.render.slabs = 64;
        scene.render.scattering = "propagation";
        scene.render.propagation.onto_surfaces = true;
        return scene;
    }
    static Picture seen(const Scene& scene, const Pose& from) { return render(device(), scene, from, kWidth, kHeight); }
};

// A thin ball of soot far above the ground shines as a point of the power that it emits, 4 pi E times its mass.
TEST_F(MediumGlowTest, AFarBallOfSootIsAPoint) {
    const float height = 8, scale = 1, sigma_t = 0.05f;
    Scene scene = over({{{0, 0, 0}, scale, sigma_t, glm::vec3(0)}}, -height);
    scene.medium.emission = {40, 20, 10};
    scene.render.cutoff = 0;
    const Pose from = lookAt({0, -2, 18}, {0, -8, 0}, 0.7f);
    const Picture picture = seen(scene, from);
    const double k = std::sqrt(50.0) / double(scale * 1.6f), mass = double(sigma_t) * std::pow(kPi, 1.5) / (k * k * k);
    double most = 0;
    int compared = 0;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const Ray ray = rayThrough(from, kWidth, kHeight, x, y);
            if (!(ray.w.y < -0.1)) continue;
            const glm::dvec3 at = ray.eye + ray.w * ((-double(height) - ray.eye.y) / ray.w.y);
            const double square = glm::dot(at, at), cosine = double(height) / std::sqrt(square);
            for (int c = 0; c < 3; ++c) {
                const double exact =
                    double(scene.planes[0].albedo[c] * scene.medium.emission[c]) / kPi * mass * cosine / square;
                most = std::max(most, std::abs(double(picture.at(x, y)[c]) / exact - 1));
            }
            ++compared;
        }
    std::printf("a ball of soot as a point: within %.1e on %d pixels\n", most, compared);
    EXPECT_GT(compared, 180);
    EXPECT_LT(most, 0.015);
}

// Off, the ground has none of it.
TEST_F(MediumGlowTest, IsNotThereWhereItIsNotAsked) {
    Scene scene = over({{{0, 0, 0}, 1, 0.05f, glm::vec3(0)}}, -8);
    scene.medium.emission = {40, 20, 10};
    scene.render.propagation.onto_surfaces = false;
    for (const glm::vec4& pixel : seen(scene, lookAt({0, -2, 18}, {0, -8, 4}, 0.3f)).pixels)
        ASSERT_EQ(glm::vec3(pixel), glm::vec3(0));
}

struct Case {
    const char* name;
    float sigma_t, ground;
    bool fire;
    bool in_whole_layer_alone; // True: in no other layer
    double rmse;               // allowed: one and a half times the measured one
};

// What a surface gets of it, beside random paths: fire over its ground, and a coloured cloud in the sun.
TEST_F(MediumGlowTest, IsNearToRandomPaths) {
    for (const Case& c :
         {Case{"fire", 0.3f, -2.5f, true, false, 0.17}, Case{"fire far above", 0.3f, -6, true, true, 0.105},
          Case{"thin cloud", 0.1f, -4, false, true, 0.08}, Case{"dense cloud", 1, -4, false, true, 0.78}}) {
        if (c.in_whole_layer_alone && !whole()) continue;
        std::vector<Point> points = randomPoints(80, 4, 5, c.sigma_t);
        for (Point& p : points) p.albedo = c.fire && p.centre.y < 0 ? glm::vec3(0.1f) : glm::vec3(1, 0.9f, 0.6f);
        Scene scene = over(points, c.ground);
        if (c.fire)
            scene.medium.emission = {9, 4, 1};
        else
            scene.lights = {{.to_light = glm::normalize(glm::vec3(0.5f, 0.8f, 0.3f)), .irradiance = glm::vec3(10)}};
        const Pose from = lookAt({2, c.ground + 4, 12}, {0, c.ground, 1}, 0.8f);
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        reference::World world = reference::worldOf(scene, particles);
        const reference::Camera camera = reference::perspective(from, kWidth, kHeight);
        const reference::TrackedPicture with = truePaths(world, camera, kPaths);
        world.onto_surfaces = false;
        const reference::TrackedPicture without = truePaths(world, camera, kPaths);
        const Picture lit = seen(scene, from);
        scene.render.propagation.onto_surfaces = false;
        const Picture dark = seen(scene, from);
        double errors = 0, noise = 0, squares = 0, got = 0, exact = 0;
        for (size_t i = 0; i < lit.pixels.size(); ++i) {
            if (dark.pixels[i].a < 0.99f) continue; // the ground beside the medium
            const glm::dvec3 own(lit.pixels[i] - dark.pixels[i]), right = with.radiance[i] - without.radiance[i];
            const glm::dvec3 off = own - right;
            errors += glm::dot(off, off), squares += glm::dot(right, right);
            noise += glm::dot(with.standard_error[i], with.standard_error[i]) +
                     glm::dot(without.standard_error[i], without.standard_error[i]);
            got += own.x + own.y + own.z, exact += right.x + right.y + right.z;
        }
        const double rmse = std::sqrt(std::max(errors - noise, 0.0) / std::max(squares - noise, 1e-30));
        std::printf("%s: bias %+.1f %%, RMSE %.1f %%, noise %.1f %%\n", c.name, 100 * (got / exact - 1), 100 * rmse,
                    100 * std::sqrt(noise / squares));
        EXPECT_LT(rmse, c.rmse) << c.name;
    }
}

} // namespace
} // namespace brume::test::medium_glow_test

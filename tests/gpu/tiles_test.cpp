// Method tiles: against sphere, whose sum it makes in the other order; light cached on the particles; where rays end;
// sizes.
#include <algorithm>
#include <cmath>

#include "tests/gpu/closed_form.h"
#include "tests/gpu/quadrature.h"
#include "tests/layer.h"

namespace brume::test::tiles_test {
namespace {

constexpr uint32_t kWidth = 70, kHeight = 45; // no multiple of a tile's

class TilesTest : public GpuTest {
protected:
    static Picture see(Stage& stage, Scene scene, const char* method, const char* quadrature, const Pose& pose) {
        scene.render.method = method;
        setQuadrature(scene.render, quadrature);
        return stage.see(scene, pose, kWidth, kHeight);
    }

    struct Difference {
        double transmittance = 0, radiance = 0; // largest; of radiance as a part of the brightest
        int far = 0;                            // pixels whose radiance differs by more than 1e-4 of that
        double darkest = 1;                     // transmittance
    };
    static Difference compare(const Picture& a, const Picture& b) {
        double brightest = 0;
        for (const glm::vec4& pixel : a.pixels)
            brightest = std::max(brightest, double(std::max({pixel.r, pixel.g, pixel.b})));
        Difference worst;
        for (size_t i = 0; i < a.pixels.size(); ++i) {
            const glm::dvec4 apart = glm::abs(glm::dvec4(a.pixels[i]) - glm::dvec4(b.pixels[i]));
            const double radiance = std::max({apart.r, apart.g, apart.b}) / brightest;
            EXPECT_TRUE(std::isfinite(radiance) && std::isfinite(apart.a)) << i;
            worst.transmittance = std::max(worst.transmittance, apart.a);
            worst.radiance = std::max(worst.radiance, radiance);
            worst.far += radiance > 1e-4;
            worst.darkest = std::min(worst.darkest, double(a.pixels[i].a));
        }
        return worst;
    }
};

// 300 overlapping particles of many albedos; depths up to 5, so that both forms of the opacity are used.
std::vector<Point> colourful(uint32_t seed) {
    Random random(seed);
    std::vector<Point> points = randomPoints(300, 8, 2.5f, 0.9f, seed);
    for (Point& p : points) p.albedo = glm::vec3(0.5f) + random.inCube(0.5f);
    for (size_t i = 0; i < points.size(); i += 50) points[i].sigma_t = 6;
    return points;
}

const Pose kPoses[] = {lookAt({0, 2, 20}, {0, 0, 0}, 0.7f),   lookAt({1, 0, 2}, {-1, 0, 0}, 1.2f),
                       lookAt({0.3f, 0.2f, 0}, {0, 0, 1}, 2), lookAt({0, 30, 0}, {0, 0, 0}, 0.4f),
                       lookAt({4, 3, 5}, {9, 9, 0}, 2.6f),    lookAt({300, 200, 700}, {0, 0, 0}, 0.02f)};

// What two methods may differ by that add 300 particles in opposite orders: of each the roundings of its opacity, of
// the product and of the sum. And places, rounded to an ulp of the distance: see allowed() for T, light changes by up
// to 3 k there.
constexpr double kRounding = 300 * 2.0 / double(1 << 24);
double rounding(const Pose& pose) { return kRounding + 6 * 2e-7 * double(glm::length(pose.position)); }

TEST_F(TilesTest, HermiteIsWhatSphereDraws) {
    for (const float lobe : {0.0f, 0.8f})
        for (const Pose& pose : kPoses) {
            Scene scene = sceneOf(colourful(3), 1.6f);
            scene.medium.anisotropy = lobe;
            scene.medium.asymmetry = 0.6f;
            scene.render.tiles.least_transmittance = 0;
            const Difference d =
                compare(see(plain(), scene, "sphere", "", pose), see(plain(), scene, "tiles", "hermite", pose));
            EXPECT_LT(d.transmittance, rounding(pose)) << pose.position.x << ' ' << lobe;
            EXPECT_LT(d.radiance, rounding(pose)) << pose.position.x << ' ' << lobe;
            EXPECT_LT(d.darkest, 0.5) << pose.position.x;
        }
}

// Surfaces and the near plane cut particles; boxes and spheres throw shafts; ambient light.
TEST_F(TilesTest, HermiteIsWhatSphereDrawsAmongObjects) {
    Scene scene = sceneOf(colourful(5), 1.6f);
    scene.planes = {{-2, glm::vec3(0.5f)}};
    scene.boxes = {{{1, 2, 0}, {3, 0.5f, 1}, 0.7f, glm::vec3(0.5f)},
                   {{-2, -1, 1}, {1, 2, 1.5f}, -0.3f, glm::vec3(0.5f)}};
    scene.spheres = {{{0, 0.5f, 3}, 0.9f, glm::vec3(0.5f)}};
    scene.sky = {glm::vec3(0.3f, 0.5f, 0.9f), glm::vec3(0.7f), glm::vec3(0.2f)};
    scene.render.tiles.least_transmittance = 0;
    Stage stage(device(), scene, 300);
    for (const Pose& pose : kPoses) {
        if (pose.position.y < 1) continue; // below the ground's middle
        const Picture sphere = see(stage, scene, "sphere", "", pose),
                      tiles = see(stage, scene, "tiles", "hermite", pose);
        const Difference d = compare(sphere, tiles);
        EXPECT_LT(d.transmittance, 2 * rounding(pose)) << pose.position.x; // surfaces too have places
        // A point on the edge of the opaque map's texel is rounded to either side: one point of one particle each.
        EXPECT_LT(d.radiance, 0.1) << pose.position.x;
        EXPECT_LT(d.far, int(kWidth * kHeight) / 20) << pose.position.x;
        EXPECT_LT(d.darkest, 0.9) << pose.position.x;
    }
}

// With no tolerance all light is looked up: the two quadratures are one.
TEST_F(TilesTest, CachedWithoutToleranceIsHermite) {
    for (const Pose& pose : kPoses) {
        Scene scene = sceneOf(colourful(7), 1.6f);
        scene.render.tiles.light_tolerance = 0;
        const Difference d =
            compare(see(plain(), scene, "tiles", "hermite", pose), see(plain(), scene, "tiles", "cached", pose));
        EXPECT_LT(d.transmittance, 1e-6) << pose.position.x; // two pipelines' roundings
        EXPECT_LT(d.radiance, 1e-5) << pose.position.x;
    }
}

// A particle where the light falls off evenly: in the half shadow of one ten times its size. Its line whole, cut by the
// near plane, by the ground through its middle, by both.
TEST_F(TilesTest, CachedIsExactWhereLightIsLinear) {
    BRUME_WHOLE_LAYER_ONLY();
    const Point blocker = thick({0, 0, 0}, 10, 1.5, 1.6f);
    const double k = std::sqrt(50.0) / 16;
    for (const bool ground : {false, true})
        for (const glm::vec3 to_light : {glm::vec3(0, 1, 0), glm::normalize(glm::vec3(1, 2, 1))}) {
            const glm::vec3 side = glm::normalize(glm::cross(to_light, glm::vec3(0.2f, 0.1f, 1)));
            const glm::vec3 at =
                side * float(std::sqrt(0.5) / k) - to_light * 9.0f; // where a Gaussian's slope is largest
            Scene scene = sceneOf({blocker, thick(at, 1, 1, 1.6f)}, 1.6f);
            if (ground) scene.planes = {{at.y, glm::vec3(0)}};
            Stage stage(device(), scene, 2);
            for (const double depth : {0.02, 0.2, 0.5}) {
                const Point point = thick(at, 1, depth, 1.6f);
                for (const float away : {4.0f, 0.1f}) {
                    const Pose pose = lookAt(at + glm::vec3(0.02f, away, 0.05f), at, 0.1f);
                    const auto seen = [&](const Point& p) {
                        Scene now = sceneOf({blocker, p}, 1.6f);
                        now.planes = scene.planes;
                        now.lights[0].to_light = to_light;
                        now.lights[0].irradiance = glm::vec3(float(4 * kPi));
                        now.render.shadow_size = 256;
                        now.render.shadow_slices = 64;
                        now.render.tiles.least_transmittance = 0;
                        return see(stage, now, "tiles", "cached", pose);
                    };
                    const Picture with = seen(point), without = seen({at, 1, 0}); // what it adds is the rest
                    const auto blobs = blobsOf(sceneOf({blocker, point}, 1.6f));
                    const reference::LightField field(blobs, glm::dvec3(to_light));
                    double error = 0, largest = 0;
                    for (uint32_t y = 0; y < kHeight; ++y)
                        for (uint32_t x = 0; x < kWidth; ++x) {
                            const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
                            Interval part = wholeRay(ray);
                            if (ground) part.end = (double(at.y) - ray.eye.y) / ray.w.y;
                            const double exact =
                                scatteredOn(blobs[1], ray, part, [&](double t) { return field.depth(ray.at(t)); });
                            const double through = double(with.at(x, y).a / without.at(x, y).a);
                            const double added = double(with.at(x, y).r) - double(without.at(x, y).r) * through;
                            error = std::max(error, std::abs(added - exact));
                            largest = std::max(largest, exact);
                        }
                    EXPECT_GT(largest, 0.02 * depth) << ground << ' ' << away;
                    // The blocker's light bends by (0.22 / 1.6)^2 / 2 of itself within 1/k of the particle. Its own
                    // shadow is a polynomial but for terms of third order, up to depth / 6 where half of it is seen.
                    EXPECT_LT(error / largest, 0.01 + depth / 6) << depth << ' ' << ground << ' ' << away;
                }
            }
        }
}

// What the particles' common albedo saves changes nothing.
TEST_F(TilesTest, OneAlbedoIsAsMany) {
    for (const Pose& pose : {kPoses[0], kPoses[1]}) {
        std::vector<Point> points = randomPoints(200, 8, 2.5f, 0.9f);
        for (Point& p : points) p.albedo = {0.9f, 0.6f, 0.3f};
        const Scene one = sceneOf(points, 1.6f);
        points[7].albedo.r = std::nextafter(0.9f, 1.0f);
        const Scene many = sceneOf(points, 1.6f);
        for (const char* quadrature : {"cached", "hermite"}) {
            const Difference d =
                compare(see(plain(), one, "tiles", quadrature, pose), see(plain(), many, "tiles", quadrature, pose));
            EXPECT_LT(d.transmittance, 1e-6);
            EXPECT_LT(d.radiance, kRounding);
        }
    }
}

// What a ray leaves out at its end is no more than the setting, of transmittance and of the brightest that can lie
// there.
TEST_F(TilesTest, RaysEndWhereLittleIsSeen) {
    std::vector<Point> points;
    for (int i = 0; i < 100; ++i) points.push_back(thick({0, 0, -0.5f * float(i)}, 6, 0.2, 1.6f));
    Scene scene = sceneOf(points, 1.6f);
    scene.sky.zenith = scene.sky.horizon = glm::vec3(1);
    scene.lights[0].irradiance = glm::vec3(float(4 * kPi));
    scene.render.shadow_size = 64;
    Stage stage(device(), scene, 100);
    const Pose pose = lookAt({0, 0, 20}, {0, 0, 0}, 0.1f);
    scene.render.tiles.least_transmittance = 0;
    const Picture whole = see(stage, scene, "tiles", "cached", pose);
    for (const float least : {1e-3f, 0.05f}) {
        scene.render.tiles.least_transmittance = least;
        const Picture ended = see(stage, scene, "tiles", "cached", pose);
        double most = 0;
        for (size_t i = 0; i < whole.pixels.size(); ++i) {
            EXPECT_LE(std::abs(ended.pixels[i].a - whole.pixels[i].a), least);
            EXPECT_LE(std::abs(ended.pixels[i].r - whole.pixels[i].r), least); // sky and source are 1 at most
            most = std::max(most, double(ended.pixels[i].a - whole.pixels[i].a));
        }
        EXPECT_GT(most, 0) << "no ray ended";
    }
}

// So many blocks of tiles and particles that their lists would not fit: blocks grow, the picture stays.
TEST_F(TilesTest, AMillionParticlesInTwoMegapixels) {
    BRUME_WHOLE_LAYER_ONLY();
    constexpr uint32_t kCount = 1'000'000;
    std::vector<Point> points;
    Random random(1);
    for (uint32_t i = 0; i + 4 < kCount; ++i)
        points.push_back(thick(random.inCube(2) + glm::vec3(0, 0, 60), 0.1f, 1e-6, 0.3f));
    const glm::vec3 places[] = {{-9, 4, 0}, {9, 4, 0}, {-9, -4, 0}, {9, -4, 0}};
    for (const glm::vec3 place : places) points.push_back(thick(place, 3, 1, 0.3f));
    Scene scene = sceneOf(points, 0.3f);
    scene.render.method = "tiles";
    setQuadrature(scene.render, "cached");
    scene.render.shadow_size = 16;
    scene.render.shadow_slices = 2;
    Stage stage(device(), scene, kCount);
    constexpr uint32_t kWide = 2048, kTall = 1056;
    const Pose pose = lookAt({0, 0, 20}, {0, 0, 0}, 0.6f); // the million lies behind
    const Picture picture = stage.see(scene, pose, kWide, kTall);
    const auto blobs = blobsOf(scene);
    int dark = 0;
    for (uint32_t y = 3; y < kTall; y += 7)
        for (uint32_t x = 5; x < kWide; x += 7) {
            const Ray ray = rayThrough(pose, kWide, kTall, x, y);
            double depth = 0;
            for (size_t i = kCount - 4; i < kCount; ++i) depth += depthOn(blobs[i], ray, wholeRay(ray));
            ASSERT_NEAR(picture.at(x, y).a, std::exp(-depth), allowed(20, blobs.back().k, 1)) << x << ' ' << y;
            dark += depth > 0.1;
        }
    EXPECT_GT(dark, 50);
}

} // namespace
} // namespace brume::test::tiles_test

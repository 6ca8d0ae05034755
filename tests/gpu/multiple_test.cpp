// Light that scatters more than once: pictures by octaves and by propagation, against random paths in double precision
// and against laws.
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/gpu/closed_form.h"
#include "tests/gpu/light_passes.h"
#include "tests/gpu/truth.h"
#include "tests/layer.h"
#include "tools/reference/camera.h"
#include "tools/reference/world.h"

namespace brume::test::multiple_test {
namespace {

constexpr uint32_t kWidth = 48, kHeight = 27;
const Pose kFrom = lookAt({3, 2, 11}, {0, 0, 0}, 0.7f);
const Pose kWithin = lookAt({3, 2, 11}, {0, 0, 0}, 0.35f); // sees nothing beside the cloud
const glm::vec3 kFromTheRight = glm::normalize(glm::vec3(1, 0.7f, 0.4f));

class MultipleTest : public GpuTest {
protected:
    // 60 particles within 3 m. `sigma_t`: of each, 1/m; where seven overlap the mean free path is a seventh of
    // 1/sigma_t.
    static Scene cloud(float sigma_t, const std::string& scattering, glm::vec3 albedo = glm::vec3(0.98f)) {
        std::vector<Point> points = randomPoints(60, 4, 6, sigma_t);
        for (Point& point : points) point.albedo = albedo;
        Scene scene = sceneOf(points, 1.6f);
        scene.render.method = "slabs";
        scene.render.rate = 1;
        scene.render.slabs = 64;
        scene.render.scattering = scattering;
        return scene;
    }
    static Picture seen(const Scene& scene, const Pose& from = kFrom) {
        return render(device(), scene, from, kWidth, kHeight);
    }

    static double sum(const Picture& picture) {
        double all = 0;
        for (const glm::vec4& pixel : picture.pixels) all += double(pixel.r) + double(pixel.g) + double(pixel.b);
        return all;
    }

    struct Error {
        double bias, rmse; // of total radiance, in parts of its mean and its RMS; without the noise of the paths
    };
    static reference::TrackedPicture truthOf(const Scene& scene, const Pose& from = kFrom) {
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        return truePaths(reference::worldOf(scene, particles), reference::perspective(from, kWidth, kHeight), 96);
    }
    static Error beside(const Picture& picture, const reference::TrackedPicture& truth) {
        double errors = 0, noise = 0, squares = 0, got = 0, exact = 0;
        for (size_t i = 0; i < truth.radiance.size(); ++i) {
            const glm::dvec3 value(picture.pixels[i]), off = value - truth.radiance[i];
            errors += glm::dot(off, off), squares += glm::dot(truth.radiance[i], truth.radiance[i]);
            noise += glm::dot(truth.standard_error[i], truth.standard_error[i]);
            got += value.x + value.y + value.z;
            exact += truth.radiance[i].x + truth.radiance[i].y + truth.radiance[i].z;
        }
        return {got / exact - 1, std::sqrt(std::max(errors - noise, 0.0) / squares)};
    }
};

TEST_F(MultipleTest, PropagationIsNearRandomPaths) {
    BRUME_WHOLE_LAYER_ONLY();
    struct Case {
        const char *name, *method;
        float sigma_t;
        glm::vec3 albedo;
        float anisotropy, asymmetry;
        double bias = 0.05, rmse = 0.1; // allowed
    };
    constexpr glm::vec3 kWhite(0.98f);
    for (const Case& c :
         {Case{"thin", "slabs", 0.02f, kWhite, 0, 0}, Case{"medium", "slabs", 0.2f, kWhite, 0, 0},
          Case{"medium", "grid", 0.2f, kWhite, 0, 0}, Case{"dense", "slabs", 2, kWhite, 0, 0, 0.08, 0.12},
          Case{"forward", "slabs", 0.5f, kWhite, 1, 0.6f}, Case{"backward", "slabs", 0.5f, kWhite, 1, -0.4f},
          Case{"coloured", "slabs", 0.5f, {0.99f, 0.8f, 0.4f}, 0, 0}}) {
        Scene scene = cloud(c.sigma_t, "propagation", c.albedo);
        scene.medium.anisotropy = c.anisotropy, scene.medium.asymmetry = c.asymmetry;
        scene.render.method = c.method;
        scene.render.grid.spacing = 0.5f;
        const reference::TrackedPicture truth = truthOf(scene);
        const auto of = [&](const char* scattering) {
            scene.render.scattering = scattering;
            return beside(seen(scene), truth);
        };
        const Error error = of("propagation"), octaves = of("octaves"), single = of("single");
        std::printf("%-9s %-5s bias %+.1f %%, RMSE %.1f %%; octaves %+.1f %%, %.1f %%; single %+.1f %%, %.1f %%\n",
                    c.name, c.method, 100 * error.bias, 100 * error.rmse, 100 * octaves.bias, 100 * octaves.rmse,
                    100 * single.bias, 100 * single.rmse);
        EXPECT_LT(std::abs(error.bias), c.bias) << c.name;
        EXPECT_LT(error.rmse, c.rmse) << c.name;
        EXPECT_LT(error.rmse, 0.5 * single.rmse) << c.name;
    }
}

// Objects shadow the first scattering alone: a shadow in the medium gets light from around it.
TEST_F(MultipleTest, ShadowsOfObjectsAreNoHoles) {
    Scene scene = cloud(0.3f, "propagation");
    scene.medium.anisotropy = 0.8f, scene.medium.asymmetry = 0.5f; // some of it goes straight on
    scene.boxes = {{{1.2f, 5.5f, 3}, {3, 0.2f, 3}, 0, glm::vec3(0)}};
    const Picture shadowed = seen(scene);
    const Error error = beside(shadowed, truthOf(scene));
    std::printf("below a box: bias %+.1f %%, RMSE %.1f %%\n", 100 * error.bias, 100 * error.rmse);
    EXPECT_LT(error.rmse, 0.15);
    scene.render.scattering = "single";
    EXPECT_GT(sum(shadowed), 1.3 * sum(seen(scene)));
}

// What planes, boxes and spheres send back into the medium. These are beside the picture, since paths go through the
// middles of pixels and see hard edges.
TEST_F(MultipleTest, LightOfSurfacesIsNearRandomPaths) {
    BRUME_WHOLE_LAYER_ONLY();
    struct Case {
        const char* name;
        float sigma_t;
        std::vector<Plane> planes;
        std::vector<Box> boxes;
        std::vector<Sphere> spheres;
        double rmse; // allowed
        float asymmetry = 0;
    };
    constexpr glm::vec3 kWhite(0.9f), kRed(0.9f, 0.4f, 0.1f);
    const Plane white{.height = -4, .albedo = kWhite}, red{.height = -4, .albedo = kRed};
    const Box wall{{-7, 0, -1}, {1, 8, 8}, 0.2f, kWhite};
    const Sphere ball{{-8, 0, 0}, 3.5f, kWhite};
    const Box slab{{0, -5, 0}, {500, 2, 500}, 0.2f, kWhite}; // as large as the plane, by and large
    for (const Case& c : {Case{"plane, thin", 0.02f, {white}, {}, {}, 0.02},
                          {"plane, medium", 0.2f, {white}, {}, {}, 0.03},
                          {"red plane", 0.2f, {red}, {}, {}, 0.025},
                          {"sphere", 0.1f, {}, {}, {ball}, 0.03},
                          {"wall", 0.1f, {}, {wall}, {}, 0.045},
                          {"all", 0.1f, {red}, {wall}, {ball}, 0.055},
                          {"slab", 0.2f, {}, {slab}, {}, 0.045},
                          {"plane, g 0.6", 0.2f, {white}, {}, {}, 0.05, 0.6f},
                          {"slab, g 0.6", 0.2f, {}, {slab}, {}, 0.055, 0.6f},
                          {"plane, dense", 3, {white}, {}, {}, 0.25}}) {
        Scene scene = cloud(c.sigma_t, "propagation");
        scene.lights[0].to_light = kFromTheRight;
        scene.planes = c.planes, scene.boxes = c.boxes, scene.spheres = c.spheres;
        scene.medium.anisotropy = c.asymmetry > 0 ? 1 : 0, scene.medium.asymmetry = c.asymmetry;
        const Pose from = c.planes.empty() && c.boxes != std::vector{slab} ? kWithin : kFrom;
        const reference::TrackedPicture truth = truthOf(scene, from);
        const auto with = [&](uint32_t parts) {
            scene.render.propagation.surface_parts = parts;
            return beside(seen(scene, from), truth);
        };
        const Error error = with(4), coarse = with(2), fine = with(16), without = with(0);
        EXPECT_LT(coarse.rmse, 1.5 * c.rmse) << c.name;
        EXPECT_LT(fine.rmse, c.rmse) << c.name;
        std::printf("%-14s bias %+.1f %%, RMSE %.1f %%; 2 parts %+.1f %%, %.1f %%; 16 parts %+.1f %%, %.1f %%; "
                    "without %+.1f %%, %.1f %%\n",
                    c.name, 100 * error.bias, 100 * error.rmse, 100 * coarse.bias, 100 * coarse.rmse, 100 * fine.bias,
                    100 * fine.rmse, 100 * without.bias, 100 * without.rmse);
        EXPECT_LT(error.rmse, c.rmse) << c.name;
        EXPECT_LT(error.rmse, (c.sigma_t < 1 ? 0.5 : 0.7) * without.rmse) << c.name; // cells of depth 10 keep some
    }
}

// An endless plane sends back what it gets: half of all directions have its radiance a cos / pi.
TEST_F(MultipleTest, APlaneBelowAThinMediumAddsWhatItReflects) {
    const Pose up = lookAt({3, -1, 11}, {0, 3, 0}, 0.35f); // sees no plane
    for (const float albedo : {0.3f, 0.9f}) {
        Scene scene = cloud(1e-4f, "propagation");
        scene.lights[0].to_light = kFromTheRight;
        scene.planes = {{.height = -5, .albedo = glm::vec3(albedo)}};
        const double lit = sum(seen(scene, up));
        scene.render.scattering = "single";
        EXPECT_NEAR(lit / sum(seen(scene, up)), 1 + 2 * albedo * kFromTheRight.y, 2e-3) << albedo;
    }
}

// No light comes through the ground: not from a plane below another, and not to what lies below it.
TEST_F(MultipleTest, NoLightComesThroughAPlane) {
    Scene scene = cloud(0.3f, "propagation");
    scene.planes = {{.height = -4, .albedo = glm::vec3(0.9f)}, {.height = -1, .albedo = glm::vec3(0)}};
    const Picture both = seen(scene);
    scene.planes.erase(scene.planes.begin());
    EXPECT_EQ(both.pixels, seen(scene).pixels);
}

TEST_F(MultipleTest, ColouredObjectsHaveThreeChannelsOfLight) {
    Scene scene = cloud(0.3f, "propagation");
    const auto channels = [&] {
        return tickOf(scene, std::vector<gpu::Particle>(1, {.scale = 1, .sigma_t = 1})).multiple.channels;
    };
    EXPECT_EQ(channels(), 1u);
    scene.boxes = {{{-7, 0, -1}, {1, 8, 8}, 0, {0.5f, 0.48f, 0.45f}}};
    EXPECT_EQ(channels(), 1u);
    scene.boxes[0].albedo.z = 0.3f;
    EXPECT_EQ(channels(), 3u);
    scene.render.propagation.surface_parts = 0;
    EXPECT_EQ(channels(), 1u);
}

// A black fog between the sun and all that it lights dims everything alike.
TEST_F(MultipleTest, FogTowardTheSunDimsAllOrders) {
    for (const bool surfaces : {false, true}) {
        Scene scene = cloud(0.3f, "propagation");
        scene.lights[0].to_light = {0, 1, 0};
        if (surfaces) scene.planes = {{.height = -4, .albedo = glm::vec3(0.9f)}};
        const double bright = sum(seen(scene, kWithin));
        scene.fogs = {{.extinction = 1, .lo = 9, .hi = 10, .albedo = glm::vec3(0)}};
        EXPECT_NEAR(sum(seen(scene, kWithin)) / bright, std::exp(-1), 1e-4) << surfaces;
    }
}

// The medium dims nothing itself. So octave n is single scattering times 2^-n, with its own phase function and what a
// black fog of depth 1 leaves of its light.
TEST_F(MultipleTest, OctavesAddUp) {
    BRUME_WHOLE_LAYER_ONLY();
    constexpr double kAsymmetry = 0.5, kPart = 0.7, kSameInAll = 1 - kPart;
    const auto lobe = [](double g, double cosine) {
        return (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5); // 4 pi sr times the phase function
    };
    for (const bool box : {false, true}) { // with shadows of objects they are kept apart from the sun's light
        Scene scene = cloud(1e-4f, "octaves");
        scene.render.cutoff = 0;
        scene.medium.anisotropy = float(kPart), scene.medium.asymmetry = float(kAsymmetry);
        scene.lights[0].to_light = {0, 1, 0};
        scene.fogs = {{.extinction = 1, .lo = 9, .hi = 10, .albedo = glm::vec3(0)}};
        if (box) scene.boxes = {{{1.2f, 5.5f, 3}, {3, 0.2f, 3}, 0, glm::vec3(0)}};
        const Picture octaves = seen(scene, kWithin);
        scene.render.scattering = "single";
        const Picture single = seen(scene, kWithin);
        float largest = 0;
        for (const glm::vec4& pixel : octaves.pixels) largest = std::max(largest, pixel.r);
        EXPECT_GT(largest, 0);
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const double cosine =
                    glm::normalize(pixelDirection(kWithin, kWidth, kHeight, x, y)).y; // light goes down
                double sum = 0;
                for (int n = 0; n < 8; ++n) {
                    const double part = std::pow(0.5, n);
                    sum += part * std::exp(-part) * (kSameInAll + kPart * lobe(part * kAsymmetry, cosine));
                }
                const double first = std::exp(-1) * (kSameInAll + kPart * lobe(kAsymmetry, cosine));
                // 0.2 %: the medium's own depth
                ASSERT_NEAR(octaves.at(x, y).r, sum / first * double(single.at(x, y).r), 2e-3 * double(largest))
                    << x << ' ' << y << ' ' << box;
            }
    }
}

// The picture of a tick depends on nothing that was drawn before.
TEST_F(MultipleTest, NothingIsKeptFromOneTickToTheNext) {
    const Scene scene = cloud(0.5f, "propagation");
    const Picture fresh = seen(scene);
    Stage stage(device(), scene, 60);
    for (const float sigma_t : {2.0f, 0.1f}) stage.see(cloud(sigma_t, "propagation"), kFrom, kWidth, kHeight);
    EXPECT_EQ(stage.see(scene, kFrom, kWidth, kHeight).pixels, fresh.pixels);
}

// Nor on what was drawn while light scattered otherwise, or in other colours.
TEST_F(MultipleTest, WhatChangesMeanwhileIsSeen) {
    Scene scene = cloud(0.5f, "propagation");
    const Scene first = scene;
    Stage stage(device(), scene, 60);
    const auto see = [&](const Scene& now) { return stage.see(now, kFrom, kWidth, kHeight).pixels; };
    see(scene);
    scene.render.scattering = "single";
    scene.lights[0].to_light = glm::vec3(0, 1, 0);
    see(scene), see(scene);
    scene.render.scattering = "propagation";
    EXPECT_EQ(see(scene), seen(scene).pixels);
    scene.medium.extinction_colour = {1, 0.5f, 0.2f};
    EXPECT_EQ(see(scene), seen(scene).pixels);
    scene.medium.extinction_colour = glm::vec3(1);
    EXPECT_EQ(see(scene), seen(scene).pixels);
    scene.planes = {{.height = -4}}, scene.spheres = {{{-4, -2, 0}, 1}};
    EXPECT_EQ(see(scene), seen(scene).pixels);
    scene.spheres[0].albedo = {0.9f, 0.2f, 0.1f};
    EXPECT_EQ(see(scene), seen(scene).pixels);
    scene.fogs = {{.extinction = 0.1f}};
    EXPECT_EQ(see(scene), seen(scene).pixels);
    EXPECT_EQ(see(first), seen(first).pixels);
}

// Neither a camera nor a sun nor a bright object that moves slowly makes pictures pop: a pixel goes on as it did in the
// frames before. Cells follow the sun and the particles' bounds, so that a sun which turns is the harder case.
TEST_F(MultipleTest, SlowMotionDoesNotPop) {
    BRUME_WHOLE_LAYER_ONLY();
    constexpr int kFrames = 12;
    enum class Moves { camera, sun, sphere };
    Stage stage(device(), cloud(0.5f, "single"), 60);
    const auto roughest = [&](const char* scattering, Moves moves) {
        std::vector<std::vector<glm::vec4>> frames;
        float largest = 0, change = 0;
        for (int i = 0; i < kFrames; ++i) {
            Scene scene = cloud(0.5f, scattering);
            const float angle = glm::radians(0.5f * float(i));
            const glm::vec3 from(std::sin(angle), 0, std::cos(angle));
            Pose pose = kFrom;
            if (moves == Moves::camera) pose = lookAt(11.0f * from + glm::vec3(0, 2, 0), {0, 0, 0}, 0.7f);
            if (moves == Moves::sun) scene.lights[0].to_light = glm::normalize(from + glm::vec3(0, 1, 0));
            if (moves == Moves::sphere) {
                pose = kWithin;
                scene.lights[0].to_light = kFromTheRight;
                scene.spheres = {{{-8, 0, 0.05f * float(i)}, 3.5f, glm::vec3(0.9f)}};
                scene.boxes = {{{-4, -6, 0}, {4, 1, 4}, angle, glm::vec3(0.9f)}};
            }
            frames.push_back(stage.see(scene, pose, kWidth, kHeight).pixels);
        }
        for (int i = 1; i + 1 < kFrames; ++i)
            for (size_t p = 0; p < frames[0].size(); ++p) {
                largest = std::max(largest, frames[i][p].r);
                change = std::max(change, std::abs(frames[i - 1][p].r - 2 * frames[i][p].r + frames[i + 1][p].r));
            }
        return change / largest;
    };
    for (const auto& [name, moves] :
         {std::pair{"camera", Moves::camera}, {"sun", Moves::sun}, {"sphere", Moves::sphere}}) {
        const float single = roughest("single", moves);
        for (const char* scattering : {"octaves", "propagation"}) {
            const float rough = roughest(scattering, moves);
            std::printf("%s moves, %s: second difference %.5f of the brightest pixel, single %.5f\n", name, scattering,
                        double(rough), double(single));
            EXPECT_LT(rough, 0.002f) << scattering << ' ' << name;
        }
    }
}

TEST_F(MultipleTest, AnyDepthIsFinite) {
    for (const float depth : {1e-3f, 1.0f, 1e3f})
        for (const char* scattering : {"octaves", "propagation"}) {
            const Scene scene = cloud(depth, scattering, glm::vec3(1));
            const Picture picture = seen(scene);
            for (const glm::vec4& pixel : picture.pixels)
                ASSERT_TRUE(std::isfinite(pixel.r + pixel.g + pixel.b + pixel.a) && pixel.r >= 0) << depth;
            if (depth > 1e-3f) continue;
            Scene single = scene;
            single.render.scattering = "single";
            const double more = sum(picture) / sum(seen(single));
            EXPECT_GT(more, 1) << scattering;
            // Octaves add 1/2 + 1/4 + ... whatever the depth, so they are wrong where it is thin.
            EXPECT_LT(more, scattering == std::string("propagation") ? 1.03 : 2.01);
        }
}

TEST_F(MultipleTest, OtherMethodsRefuseInOneLine) {
    Scene scene = cloud(0.3f, "propagation");
    scene.render.method = "tiles";
    try {
        seen(scene);
        FAIL() << "tiles draws it";
    } catch (const gpu::Error& error) {
        EXPECT_EQ(std::string(error.what()), "tiles: it draws light that scatters once; use slabs or grid, or "
                                             "render.scattering = \"single\"");
    }
}

} // namespace
} // namespace brume::test::multiple_test

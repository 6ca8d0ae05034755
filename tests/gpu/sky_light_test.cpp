// The sky's light in the medium (Sky::lights): laws that no model of scattering may break, and random paths in double
// precision.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/render/renderer.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/fixture.h"
#include "tests/gpu/truth.h"
#include "tests/layer.h"
#include "tools/reference/camera.h"
#include "tools/reference/world.h"

namespace brume::test::sky_light_test {
namespace {

constexpr uint32_t kWidth = 48, kHeight = 27;
const Pose kFrom = lookAt({3, 2, 11}, {0, 0, 0}, 0.7f);
const glm::vec3 kEven(1, 2, 3);

class SkyLightTest : public GpuTest {
protected:
    // 60 particles within 3 m, without a sun.
    static Scene cloud(float sigma_t, glm::vec3 albedo = glm::vec3(1)) {
        std::vector<Point> points = randomPoints(60, 4, 6, sigma_t);
        for (Point& point : points) point.albedo = albedo;
        Scene scene = sceneOf(points, 1.6f);
        scene.lights[0].to_light = glm::normalize(glm::vec3(0.8f, 0.55f, 0.15f));
        scene.lights[0].irradiance = glm::vec3(0);
        scene.render.method = "slabs";
        scene.render.rate = 1;
        scene.render.slabs = 64;
        scene.render.scattering = "propagation";
        scene.sky.lights = true;
        return scene;
    }
    static Scene evenlyLit(float sigma_t, glm::vec3 albedo = glm::vec3(1)) {
        Scene scene = cloud(sigma_t, albedo);
        scene.sky.zenith = scene.sky.horizon = kEven;
        return scene;
    }
    static Scene unevenlyLit(float sigma_t, glm::vec3 albedo = glm::vec3(1)) {
        Scene scene = cloud(sigma_t, albedo);
        scene.sky.zenith = {0.06f, 0.13f, 0.32f}, scene.sky.horizon = {0.2f, 0.28f, 0.42f};
        return scene;
    }
    static Picture seen(const Scene& scene, const Pose& from = kFrom) {
        return render(device(), scene, from, kWidth, kHeight);
    }
    // Largest difference of two pictures, over the largest value of the second.
    static double apart(const Picture& a, const Picture& b) {
        double most = 0, largest = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                most = std::max(most, std::abs(double(a.pixels[i][c]) - double(b.pixels[i][c])));
                largest = std::max(largest, double(b.pixels[i][c]));
            }
        EXPECT_GT(largest, 0);
        return most / largest;
    }
    // Largest part by which a picture differs from an even radiance.
    static double unevenness(const Picture& picture, glm::vec3 even) {
        double most = 0;
        for (const glm::vec4& pixel : picture.pixels)
            for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(double(pixel[c] / even[c]) - 1));
        return most;
    }
    // Net flux and fluence of each channel on a lattice of places in the medium.
    static std::vector<gpu::ParticleFit> fluxesIn(const Scene& scene) {
        const Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "light");
        std::vector<gpu::Particle> places;
        for (int i = 0; i < 125; ++i)
            places.push_back({.centre = 1.5f * glm::vec3(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2), .scale = 1e-3f});
        renderer.submitLight(submission, simulation, scene.render, places);
        waitFor(submission.commands);
        const auto& fits = submission.fits().fits.at(0);
        return {fits.begin(), fits.end()};
    }
};

// A white furnace: what scatters all light is not seen in front of an even sky, however thick it is.
TEST_F(SkyLightTest, AWhiteMediumIsNotSeenInAnEvenSky) {
    for (const float sigma_t : {0.02f, 0.5f, 5.0f})
        for (const float asymmetry : {0.0f, 0.6f}) {
            Scene scene = evenlyLit(sigma_t);
            scene.medium.anisotropy = 1, scene.medium.asymmetry = asymmetry;
            double off = 0; // of the fluence, and net flux that there should not be
            for (const gpu::ParticleFit& fit : fluxesIn(scene))
                for (int c = 0; c < 3; ++c) {
                    const double all = 4 * kPi * double(kEven[c]);
                    off = std::max({off, std::abs(double(fit.fluence[c].w) / all - 1),
                                    double(glm::length(glm::vec3(fit.fluence[c]))) / all});
                }
            const double pixel = unevenness(seen(scene), kEven);
            std::printf("furnace of extinction %g, g %g: fluence off by %.1e, pixels by %.1e\n", double(sigma_t),
                        double(asymmetry), off, pixel);
            EXPECT_LT(off, 1e-5) << sigma_t;
            EXPECT_LT(pixel, 1e-5) << sigma_t;
        }
}

// Nor above a white ground, which has the sky's radiance there.
TEST_F(SkyLightTest, AWhiteGroundIsAsBrightAsAnEvenSky) {
    Scene scene = evenlyLit(0.5f);
    scene.planes = {{.height = -4, .albedo = glm::vec3(1)}};
    EXPECT_LT(unevenness(seen(scene), kEven), 1e-4); // measured: 1.1e-5
    scene.planes[0].albedo = glm::vec3(0.5f);
    EXPECT_GT(unevenness(seen(scene), kEven), 0.1);
}

// What is thin is dimmed by nothing: it scatters the light of all directions, as uniform ambient light is scattered.
TEST_F(SkyLightTest, AThinMediumScattersItsAlbedoOfAnEvenSky) {
    const glm::vec3 albedo(0.5f, 0.8f, 0.2f);
    Scene scene = evenlyLit(2e-4f, albedo);
    scene.render.cutoff = 0;
    const Picture lit = seen(scene);
    scene.sky.lights = false;
    const Picture dimmed = seen(scene);
    scene.sky.ambient = kEven;
    const Picture ambient = seen(scene);
    double most = 0, compared = 0;
    for (size_t i = 0; i < lit.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double depth = -std::log(double(dimmed.pixels[i][c] / kEven[c]));
            if (depth < 1e-3) continue;
            const double exact = double(albedo[c] * kEven[c]) * depth;
            most = std::max(most, std::abs(double(lit.pixels[i][c] - dimmed.pixels[i][c]) / exact - 1));
            ++compared;
        }
    EXPECT_GT(compared, 300);
    std::printf("thin: rho L tau within %.2e\n", most);
    EXPECT_LT(most, 0.01); // the medium's own depth
    EXPECT_LT(apart(lit, ambient), 1e-4);
}

// No place of a medium that emits nothing is brighter than the brightest of the sky; less albedo, less light.
TEST_F(SkyLightTest, NothingIsBrighterThanTheSky) {
    for (const float sigma_t : {0.05f, 0.5f, 50.0f}) {
        const Picture white = seen(unevenlyLit(sigma_t)), grey = seen(unevenlyLit(sigma_t, glm::vec3(0.7f)));
        for (size_t i = 0; i < white.pixels.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                ASSERT_LE(white.pixels[i][c], (glm::vec3(0.2f, 0.28f, 0.42f)[c]) * 1.0001f) << sigma_t;
                ASSERT_LE(grey.pixels[i][c], white.pixels[i][c] * 1.0001f) << sigma_t;
                ASSERT_GE(grey.pixels[i][c], 0);
            }
    }
}

// A black sky changes no picture of a sun that has colours: absolute fluxes are those for an irradiance of 1, times it.
// Every way in which light that scatters again is kept.
TEST_F(SkyLightTest, TheSunsLightIsTheSame) {
    const glm::vec3 grey(0.9f), coloured(0.9f, 0.5f, 0.2f);
    struct Case {
        const char *name, *method;
        glm::vec3 albedo, sun;
        bool box = false, fog = false, many = false;
    };
    for (const Case& c : {Case{"grey", "slabs", grey, glm::vec3(2)},
                          {"coloured sun", "slabs", grey, {3, 2, 1}},
                          {"coloured albedo", "slabs", coloured, {3, 2, 1}},
                          {"many albedos", "grid", coloured, {3, 2, 1}, false, false, true},
                          {"box", "slabs", coloured, {3, 2, 1}, true},
                          {"fog", "slabs", grey, {3, 2, 1}, false, true}}) {
        Scene scene = cloud(0.5f, c.albedo);
        scene.render.method = c.method;
        scene.medium.anisotropy = 0.8f, scene.medium.asymmetry = 0.5f; // some of it goes straight on
        scene.lights[0].irradiance = c.sun;
        if (c.box) scene.boxes = {{{1.2f, 5.5f, 3}, {3, 0.2f, 3}, 0, glm::vec3(0.5f)}};
        if (c.fog) scene.fogs = {{.extinction = 0.02f, .lo = -2, .hi = 2}};
        if (c.many) {
            std::vector<Point> points = randomPoints(60, 4, 6, 0.5f);
            for (size_t i = 0; i < points.size(); ++i) points[i].albedo = i % 2 ? grey : coloured;
            scene.medium = sceneOf(points, 1.6f).medium;
        }
        scene.sky.lights = false;
        const Picture relative = seen(scene);
        scene.sky.lights = true;
        const double off = apart(seen(scene), relative);
        std::printf("%-16s absolute fluxes differ by %.1e\n", c.name, off);
        EXPECT_LT(off, 1e-5) << c.name;
    }
}

// Light adds up: of the sun and of the sky, together and each alone. Without a sun all else is as with a faint one.
TEST_F(SkyLightTest, TheSkysLightAddsToTheSuns) {
    Scene scene = unevenlyLit(0.5f, {0.9f, 0.8f, 0.7f});
    const Picture sky = seen(scene);
    scene.lights[0].irradiance = glm::vec3(1e-12f);
    EXPECT_LT(apart(seen(scene), sky), 1e-5);
    scene.lights[0].irradiance = {3, 2, 1};
    const Picture both = seen(scene);
    scene.sky.lights = false;
    Picture apart_from = seen(scene); // with the sky behind
    scene.lights[0].irradiance = glm::vec3(0);
    const Picture behind = seen(scene);
    for (size_t i = 0; i < sky.pixels.size(); ++i) apart_from.pixels[i] += sky.pixels[i] - behind.pixels[i];
    EXPECT_LT(apart(both, apart_from), 1e-5);
    EXPECT_GT(apart(sky, behind), 0.1);
}

// Absolute fluxes are made again when the sun's irradiance changes.
TEST_F(SkyLightTest, WhatChangesMeanwhileIsSeen) {
    Scene scene = unevenlyLit(0.5f);
    Stage stage(device(), scene, 60);
    for (const glm::vec3 sun : {glm::vec3(1), glm::vec3(3, 2, 1), glm::vec3(0)}) {
        scene.lights[0].irradiance = sun;
        EXPECT_EQ(stage.see(scene, kFrom, kWidth, kHeight).pixels, seen(scene).pixels);
    }
}

struct Error {
    double bias, rmse; // of the medium's own light, in parts of its mean and its RMS
};
// What scatters toward the eye: less what is seen behind.
Error beside(const Picture& picture, const Picture& behind, const reference::TrackedPicture& truth) {
    double errors = 0, noise = 0, squares = 0, got = 0, exact = 0;
    for (size_t i = 0; i < truth.radiance.size(); ++i) {
        const glm::dvec3 passed(behind.pixels[i]), value = glm::dvec3(picture.pixels[i]) - passed,
                                                   right = truth.radiance[i] - passed, off = value - right;
        errors += glm::dot(off, off), squares += glm::dot(right, right);
        noise += glm::dot(truth.standard_error[i], truth.standard_error[i]);
        got += value.x + value.y + value.z, exact += right.x + right.y + right.z;
    }
    return {got / exact - 1, std::sqrt(std::max(errors - noise, 0.0) / squares)};
}

TEST_F(SkyLightTest, IsNearerToRandomPathsThanAmbientLight) {
    struct Case {
        const char* name;
        float sigma_t, albedo;
        double rmse, least;               // allowed, and how much better than ambient light it is at least
        bool in_whole_layer_alone;        // True: in no other layer
        float asymmetry = 0, ground = -1; // ground: albedo; below 0 there is none
    };
    for (const Case& c : {Case{"thin", 0.02f, 0.95f, 0.02, 1, false},
                          Case{"medium", 0.2f, 0.95f, 0.02, 10, true},
                          {"dense", 2, 0.95f, 0.09, 4, false},
                          {"forward", 0.5f, 0.95f, 0.05, 6, true, 0.6f},
                          {"white ground", 0.2f, 0.95f, 0.02, 20, true, 0, 0.9f},
                          {"black ground", 0.2f, 0.95f, 0.095, 15, false, 0, 0}}) {
        if (c.in_whole_layer_alone && !whole()) continue;
        Scene scene = unevenlyLit(c.sigma_t, glm::vec3(c.albedo));
        scene.medium.anisotropy = c.asymmetry > 0 ? 1 : 0, scene.medium.asymmetry = c.asymmetry;
        if (c.ground >= 0) scene.planes = {{.height = -4, .albedo = glm::vec3(c.ground)}};
        const Picture lit = seen(scene);
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        const reference::TrackedPicture truth =
            truePaths(reference::worldOf(scene, particles), reference::perspective(kFrom, kWidth, kHeight), 96);
        scene.sky.lights = false;
        const Picture behind = seen(scene);
        scene.sky.ambient = 0.325f * scene.sky.zenith + 0.675f * scene.sky.horizon; // their mean
        const Error error = beside(lit, behind, truth), ambient = beside(seen(scene), behind, truth);
        std::printf("%-13s bias %+.1f %%, RMSE %.1f %%; ambient %+.1f %%, %.1f %%\n", c.name, 100 * error.bias,
                    100 * error.rmse, 100 * ambient.bias, 100 * ambient.rmse);
        EXPECT_LT(error.rmse, c.rmse) << c.name;
        EXPECT_LT(error.rmse * c.least, ambient.rmse) << c.name;
    }
}

} // namespace
} // namespace brume::test::sky_light_test

// Exact answers, each to 1e-6 of itself or better.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/reference/test_media.h"
#include "tools/reference/medium_reference.h"

namespace {

using namespace brume::reference;
using namespace brume::reference::test;

constexpr double kAccuracy = 1e-6; // what is asked of the reference; the printed errors say how much it keeps below

void expectRelative(const char* what, double got, double exact) {
    std::printf("%-60s %.12g, exact %.12g, relative error %.1e\n", what, got, exact, got / exact - 1);
    EXPECT_NEAR(got / exact, 1, kAccuracy) << what;
}

// From above a slab whose top is at y = 0.
Ray downward(double cosine) { return {{0, 1, 0}, {std::sqrt(1 - cosine * cosine), -cosine, 0}}; }

TEST(Slab, ReflectedAndTransmitted) {
    const double tau = 1.7, light_cosine = 0.6, view_cosine = 0.85, thickness = 0.4;
    World world;
    Fog slab{tau / thickness, glm::dvec3(0.9)};
    slab.lo = -thickness;
    slab.hi = 0;
    world.fogs = {slab};
    world.lights = {distant({0, light_cosine, 0.8})};
    expectRelative("slab, reflected", along(world, downward(view_cosine)).scattered.x, 0.0293998491338);
    world.lights = {distant({0, -light_cosine, 0.8})};
    const RayResult through = along(world, downward(view_cosine));
    expectRelative("slab, transmitted", through.scattered.x, 0.0131526148731);
    expectRelative("slab, transmittance", through.transmittance, std::exp(-tau / view_cosine));
}

TEST(UniformSphere, ThreeValues) {
    const double radius = 1.25, sigma = 0.7, rho = 0.8;
    World world;
    world.fogs = {{sigma, glm::dvec3(rho)}};
    world.fogs[0].radius = radius;
    const Ray ray{{0, 0, 5}, {0, 0, -1}};
    const double scale = rho / (4 * kPi);
    world.lights = {distant({0, 0, 1})};
    expectRelative("sphere, light behind the camera", along(world, ray).scattered.x,
                   scale * -std::expm1(-4 * radius * sigma) / 2);
    world.lights = {distant({0, 0, -1})};
    expectRelative("sphere, light toward the camera", along(world, ray).scattered.x,
                   scale * 2 * radius * sigma * std::exp(-2 * radius * sigma));
    world.fogs[0].sigma_t = 1 / (2 * radius);
    // Mean over the disc: with z = sqrt(1 - (r/R)^2) the integral of T 2 r dr / R^2 is that of 2 z T dz.
    const GaussLegendre rule(16);
    double mean = 0;
    for (int i = 0; i < rule.size(); ++i) {
        const double z = (rule.node(i) + 1) / 2, r = radius * std::sqrt(1 - z * z);
        mean += rule.weight(i) / 2 * 2 * z * along(world, {{r, 0, 5}, {0, 0, -1}}).transmittance;
    }
    expectRelative("sphere, disc-mean transmittance", mean, 0.528482235314);
}

TEST(Gaussian, AreaOfItsShadow) {
    const double u = 1.6, tau = 3.2, k = std::sqrt(50.0) / u;
    World world;
    world.blobs = {blob({0, 0, 0}, 1, u, tau)};
    const GaussLegendre rule(16);
    double area = 0;
    const int panels = 12;
    for (int p = 0; p < panels; ++p)
        for (int i = 0; i < rule.size(); ++i) {
            const double width = 5.5 / k / panels, r = width * (p + (rule.node(i) + 1) / 2);
            area +=
                rule.weight(i) * width / 2 * 2 * kPi * r * (1 - along(world, {{r, 0, 5}, {0, 0, -1}}).transmittance);
        }
    expectRelative("Gaussian, integral of 1 - T over the plane", area, 0.281567040834);
}

TEST(HeightFog, Depth) {
    const double r0 = 0.4, k = 0.7, y0 = 2;
    World world;
    world.fogs = {{r0, glm::dvec3(1), k}};
    for (const double dy : {-0.8, -0.3, -1e-9, 0.0, 0.25, 1.0})
        for (const double length : {0.1, 3.0, 12.0}) {
            const Ray ray{{1, y0, 2}, {0, dy, std::sqrt(1 - dy * dy)}, 0, length};
            const double x = k * dy * length, phi = std::abs(x) < 1e-6 ? 1 - x / 2 : -std::expm1(-x) / x;
            const double depth = r0 * std::exp(-k * y0) * length * phi;
            const double got = along(world, ray).transmittance;
            EXPECT_NEAR(got, std::exp(-depth), 1e-12) << dy << ' ' << length;
        }
    // Without an end: up, what is above; along the ground and down, everything.
    EXPECT_NEAR(along(world, {{0, y0, 0}, {0, 1, 0}}).transmittance, std::exp(-r0 * std::exp(-k * y0) / k), 1e-12);
    EXPECT_EQ(along(world, {{0, y0, 0}, {1, 0, 0}}).transmittance, 0);
    EXPECT_EQ(along(world, {{0, y0, 0}, {0, -1, 0}}).transmittance, 0);
}

// Light from straight above through fog that thins upward, seen along the ground: T_L is constant, T_V is homogeneous.
// Seen from above, light and view depth are the same: half of 1 - T^2.
TEST(HeightFog, Scattered) {
    World world;
    world.fogs = {{0.4, glm::dvec3(0.7), 0.5}};
    world.lights = {distant({0, 1, 0})};
    const double density = 0.4 * std::exp(-0.5), scale = 0.7 / (4 * kPi);
    expectRelative("height fog, along the ground", along(world, {{0, 1, 0}, {1, 0, 0}}).scattered.x,
                   scale * std::exp(-density / 0.5));
    expectRelative("height fog, from above",
                   along(world, {{0, 1, 0}, {0, -1, 0}, 0, 3}).scattered.x * std::exp(-density / 0.5) / scale,
                   (std::exp(-2 * density / 0.5) - std::exp(-2 * density / 0.5 * std::exp(1.5))) / 2);
}

TEST(PointLight, InAHomogeneousMedium) {
    const double beta = 0.3, angle = 0.5;
    World world;
    world.fogs = {{beta}};
    LightSource light;
    light.kind = LightSource::Kind::point;
    light.colour = glm::dvec3(2);
    light.position = {0, 0, -4};
    world.lights = {light};
    const Ray ray{{0, 0, 0}, {std::sin(angle), 0, -std::cos(angle)}, 0, 9};
    expectRelative("point light (Sun et al. 2005)", along(world, ray).scattered.x, 0.010059723129);
    // A spot whose inner cone holds the whole ray is the same; one that looks away is none.
    world.lights[0].kind = LightSource::Kind::spot;
    world.lights[0].axis = {0, 0, 1};
    world.lights[0].cos_outer = -1;
    world.lights[0].cos_inner = -0.9999;
    const glm::dvec3 end = glm::normalize(ray.at(9) - light.position);
    ASSERT_GT(end.z, -0.9999);
    expectRelative("a spot that lights everything", along(world, ray).scattered.x, 0.010059723129);
    world.lights[0].axis = {0, 0, -1};
    world.lights[0].cos_outer = std::cos(0.1);
    world.lights[0].cos_inner = std::cos(0.05);
    EXPECT_EQ(along(world, {{0, 0, 0}, {0.6, 0, 0.8}}).scattered.x, 0) << "behind the spot";
}

// The spot's smooth edge against a brute-force sum with many samples of the integrand's definition.
TEST(Spot, AcrossItsCone) {
    World world;
    world.fogs = {{0.2}};
    LightSource light;
    light.kind = LightSource::Kind::spot;
    light.colour = glm::dvec3(3);
    light.position = {0, 5, 0};
    light.axis = glm::normalize(glm::dvec3(0.1, -1, 0.2));
    light.cos_outer = std::cos(0.5);
    light.cos_inner = std::cos(0.3);
    world.lights = {light};
    const Ray ray{{-6, 0.5, 0.3}, glm::normalize(glm::dvec3(1, -0.05, 0.1)), 0, 12};
    double sum = 0;
    const int samples = 2'000'000;
    for (int i = 0; i < samples; ++i) {
        const double t = 12 * (i + 0.5) / samples;
        const glm::dvec3 away = ray.at(t) - light.position;
        const double d = glm::length(away), cosine = glm::dot(away, light.axis) / d;
        const double s = std::clamp((cosine - light.cos_outer) / (light.cos_inner - light.cos_outer), 0.0, 1.0);
        sum += s * s * (3 - 2 * s) * std::exp(-0.2 * (t + d)) / (d * d);
    }
    expectRelative("spot's cone, against 2e6 midpoints", along(world, ray).scattered.x,
                   sum * 12 / samples * 3 * 0.2 / (4 * kPi));
}

TEST(Furnace, RadianceOfEverythingIsOne) {
    World world;
    world.blobs = cloud(80, 10, 6, 0.5, glm::dvec3(1));
    world.lights = {distant({0, 1, 0}, 4 * kPi)}; // rho p E = 1
    world.sky_zenith = world.sky_horizon = glm::dvec3(1);
    Settings settings;
    settings.shadows = false;
    for (const Support support : {Support::full, Support::tetrahedron})
        for (const Composition composition : {Composition::overlapping, Composition::sequential}) {
            world.support = support;
            world.composition = composition;
            const Picture picture =
                render(world, perspective(brume::lookAt({1, 0, 2}, {0, 0, 0}, 1.2f), 12, 7), settings);
            double worst = 0;
            for (const glm::dvec3& pixel : picture.total()) worst = std::max(worst, std::abs(pixel.y - 1));
            std::printf("compositing furnace, support %d, composition %d: largest error %.1e\n",
                        static_cast<int>(support), static_cast<int>(composition), worst);
            EXPECT_LT(worst, 1e-8);
        }
}

TEST(Ambient, IsWhatTheMediumHides) {
    World world;
    world.blobs = cloud(60, 10, 6, 0.5, {0.9, 0.6, 0.3});
    world.ambient = {1, 2, 3};
    for (const Composition composition : {Composition::overlapping, Composition::sequential}) {
        world.composition = composition;
        const RayResult result = along(world, {{1, 2, 20}, glm::normalize(glm::dvec3(0, -0.1, -1))});
        ASSERT_LT(result.transmittance, 0.5);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(result.scattered[c], world.blobs[0].albedo[c] * (1 + c) * (1 - result.transmittance), 1e-8);
    }
}

// Of one mixture of soot and cold smoke, and of two: what each of them hides.
TEST(Emission, IsWhatTheMediumHidesByItsPartOfSoot) {
    World world;
    world.blobs = cloud(60, 10, 6, 0.5, {0.4, 0.2, 0});
    world.emission = {1, 2, 3};
    world.cold_albedo = {0.4, 0.8, 1};
    for (const Composition composition : {Composition::overlapping, Composition::sequential}) {
        world.composition = composition;
        const RayResult result = along(world, {{1, 2, 20}, glm::normalize(glm::dvec3(0, -0.1, -1))});
        ASSERT_LT(result.transmittance, 0.5);
        EXPECT_EQ(result.scattered.x, 0) << "it is cold";
        EXPECT_NEAR(result.scattered.y, 0.75 * 2 * (1 - result.transmittance), 1e-8);
        EXPECT_NEAR(result.scattered.z, 3 * (1 - result.transmittance), 1e-8);
    }
    world.composition = Composition::overlapping;
    world.blobs = {blob({0, 0, 0}, 2, 1.6, 0.8, {0.4, 0, 0}), blob({0, 0, -9}, 2, 1.6, 1.5, {0, 0, 0})};
    const RayResult both = along(world, {{0, 0, 20}, {0, 0, -1}});
    const double near = std::exp(-2 * world.blobs[0].half_line), far = std::exp(-2 * world.blobs[1].half_line);
    EXPECT_NEAR(both.scattered.x, near * (1 - far), 1e-8);
    EXPECT_NEAR(both.transmittance, near * far, 1e-9);
}

// An orthographic view from a, lit from b, is as bright in sum as one from b lit from a.
TEST(Reciprocity, ViewAndLightChangePlaces) {
    World world;
    world.blobs = cloud(12, 2, 4, 0.8, glm::dvec3(0.9));
    world.phase = {0.7, 0.4};
    const glm::dvec3 a = glm::normalize(glm::dvec3(0.3, 0.4, 1)), b = glm::normalize(glm::dvec3(-0.9, 0.7, 0.2));
    const auto sumOf = [&](glm::dvec3 view, glm::dvec3 light) {
        world.lights = {distant(light)};
        const int size = 64; // pixels of half the narrowest Gaussian's 1/k: their sum is the plane's integral to 1e-9
        const double height = 16;
        const Picture picture =
            render(world, orthographic(brume::lookAt(glm::vec3(20.0 * view), {0, 0, 0}, 1), size, size, height));
        double sum = 0;
        for (const glm::dvec3& pixel : picture.radiance) sum += pixel.x;
        return sum * (height / size) * (height / size);
    };
    expectRelative("reciprocity", sumOf(a, b), sumOf(b, a));
}

// Written down a second time, from the papers' own forms.
TEST(PhaseFunction, OfDropletsAndOfAirAsPrinted) {
    World world;
    brume::Medium medium;
    medium.phase = brume::kDropletPhase;
    medium.droplet = 10;
    for (const double cosine : {-1.0, -0.5, 0.0, 0.7, 1.0}) {
        const auto printed = [&](double g, double alpha) {
            return 1 / (4 * kPi) * (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5) *
                   (1 + alpha * cosine * cosine) / (1 + alpha * (1 + 2 * g * g) / 3);
        };
        const glm::dvec3 out{std::sqrt(1 - cosine * cosine), 0, cosine};
        world.phase = brume::lobesOf(medium);
        const double droplets = 0.481955 * printed(0.555671, 21.99552) + (1 - 0.481955) * printed(0.988177, 0);
        EXPECT_NEAR(phase(world.phase, {0, 0, 1}, out), droplets, 1e-4 * droplets) << cosine;
        world.phase = {1, 0, 1, 0};
        EXPECT_NEAR(phase(world.phase, {0, 0, 1}, out), 3 / (16 * kPi) * (1 + cosine * cosine), 1e-14);
    }
}

TEST(PhaseFunction, NormalisedWithItsMeanCosine) {
    World world;
    for (const double g : {-0.99, -0.5, 0.0, 0.3, 0.9, 0.999})
        for (const double a : {1.0, 0.4}) {
            world.phase = {a, g};
            // Over the cosine, in panels that halve toward the peak at +1 and at -1.
            const GaussLegendre rule(16);
            double whole = 0, mean = 0;
            for (const double side : {-1.0, 1.0})
                for (int p = 0; p < 30; ++p) {
                    const double outer = std::pow(0.5, p), inner = p == 29 ? 0 : outer / 2;
                    for (int i = 0; i < rule.size(); ++i) {
                        const double below = (outer + inner) / 2 + (outer - inner) / 2 * rule.node(i); // 1 - |cosine|
                        const double cosine = side * (1 - below), sine = std::sqrt(below * (2 - below));
                        const double p_of = phase(world.phase, {0, 0, 1}, {sine, 0, cosine});
                        const double weight = rule.weight(i) * (outer - inner) / 2 * 2 * kPi;
                        whole += weight * p_of;
                        mean += weight * p_of * cosine;
                    }
                }
            EXPECT_NEAR(whole, 1, 1e-9) << g;
            EXPECT_NEAR(mean, a * g, 1e-9) << g;
        }
}

TEST(Union, IsOneMediumHoweverManyBallsOverlap) {
    World world;
    world.balls = {{{{0, 0, 0}, 1}, {{0, 0, 0}, 1}, {{0.2, 0, 0}, 0.5}}, 0.7, glm::dvec3(0.9)};
    world.lights = {distant({0, 0, 1})};
    const Ray ray{{0, 0, 5}, {0, 0, -1}};
    expectRelative("three balls, one of them in the other, as one", along(world, ray).scattered.x,
                   0.9 / (4 * kPi) * -std::expm1(-4 * 0.7) / 2);
    expectRelative("its transmittance", along(world, ray).transmittance, std::exp(-1.4));
    // Apart, one in the other's shadow.
    world.balls = {{{{0, 0, 0}, 1}, {{0, 0, -4}, 0.5}}, 0.7, glm::dvec3(0.9)};
    expectRelative("two balls apart", along(world, ray).scattered.x, 0.9 / (4 * kPi) * -std::expm1(-2 * 0.7 * 3) / 2);
}

} // namespace

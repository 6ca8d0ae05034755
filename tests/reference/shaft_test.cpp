// Rays across shadow edges and tetrahedron faces, against sums of many samples straight from the definitions; and what
// a finer tolerance changes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include "shaders/shared/sky.h"
#include "tests/reference/test_media.h"
#include "tools/reference/medium_reference.h"

namespace {

using namespace brume::reference;
using namespace brume::reference::test;
using Kind = LightSource::Kind;

std::vector<LightSource> allLights() {
    LightSource point, spot;
    point.kind = Kind::point;
    point.position = {2, 7, 3};
    point.colour = {60, 50, 40};
    spot.kind = Kind::spot;
    spot.position = {-4, 6, 2};
    spot.axis = glm::normalize(glm::dvec3(0.6, -1, -0.3));
    spot.colour = {90, 120, 150};
    spot.cos_outer = std::cos(0.6);
    spot.cos_inner = std::cos(0.35);
    return {distant({0.5, 1, 0.2}, 3), point, spot};
}

World propsWorld() {
    World world;
    world.blobs = cloud(12, 5, 4, 0.4, {0.9, 0.8, 0.7});
    world.fogs = {{0.03, glm::dvec3(0.8), 0.1}};
    world.lights = allLights();
    world.obstacles = {{Obstacle::Kind::plane, {0, -3, 0}, glm::dvec3(0), 0, glm::dvec3(0.3)},
                       {Obstacle::Kind::box, {0.5, 3, 0}, {1, 0.4, 1.5}, 0.5, glm::dvec3(0.5, 0.2, 0.1)},
                       {Obstacle::Kind::sphere, {-1.5, 2, 0.5}, glm::dvec3(0.8), 0, glm::dvec3(0.1, 0.2, 0.5)}};
    world.sky_zenith = {0.1, 0.2, 0.4};
    world.sky_horizon = {0.3, 0.4, 0.5};
    world.ambient = {0.02, 0.03, 0.04};
    world.phase = world.fogs[0].phase = {0.6, 0.5};
    return world;
}

// Midpoint sum of the definition for light 0, with libm; channels summed. `error`: what the jumps of visibility may
// cost.
struct Brute {
    double radiance = 0, error = 0;
};
Brute bruteForce(const World& world, const Ray& ray, double end, int samples) {
    const LightSource& light = world.lights[0];
    const double h = end / samples;
    const auto blobDepth = [](const Blob& b, const Ray& r, Interval part) {
        const double closest = glm::dot(b.centre - r.origin, r.direction);
        const glm::dvec3 off = b.centre - r.at(closest);
        return part.empty() ? 0
                            : b.half_line * std::exp(-b.k * b.k * glm::dot(off, off)) *
                                  (std::erf(b.k * (part.end - closest)) - std::erf(b.k * (part.begin - closest)));
    };
    const auto member = [&](const Blob& b, glm::dvec3 x) { // of the tetrahedron's four half spaces
        const glm::dvec3 p = (x - b.centre) * std::sqrt(3.0);
        return world.support == Support::full ||
               std::max({-p.x - p.y - p.z, -p.x + p.y + p.z, p.x - p.y + p.z, p.x + p.y - p.z}) <= b.scale;
    };
    Brute result;
    double depth = 0, largest = 0;
    int changes = 0;
    std::vector<bool> seen_before, seen(world.blobs.size() + 1);
    for (int i = 0; i < samples; ++i) {
        const glm::dvec3 x = ray.at((i + 0.5) * h);
        glm::dvec3 scattering(0);
        double extinction = 0;
        for (size_t b = 0; b < world.blobs.size(); ++b) {
            const Blob& blob = world.blobs[b];
            seen[b] = member(blob, x);
            if (!seen[b]) continue;
            const double sigma = blob.sigma_t * std::exp(-blob.k * blob.k * glm::dot(x - blob.centre, x - blob.centre));
            extinction += sigma;
            scattering += sigma * blob.albedo;
        }
        for (const Fog& fog : world.fogs) {
            const double sigma = fog.sigma_t * std::exp(-fog.falloff * x.y);
            extinction += sigma;
            scattering += sigma * fog.albedo;
        }
        const Arrival arrival = arrivalAt(light, x);
        const Ray toward{x, arrival.to_light, 0, arrival.distance};
        seen.back() = !occluded(world.obstacles, toward);
        double light_depth = 0;
        for (const Blob& b : world.blobs)
            light_depth +=
                blobDepth(b, toward,
                          common({0, arrival.distance}, world.cut_light ? insideTetrahedron(b, nullptr, toward)
                                                                        : Interval{0, arrival.distance}));
        for (const Fog& fog : world.fogs) light_depth += depthOn(fog, toward);
        glm::dvec3 value = world.ambient * scattering;
        const glm::dvec3 lit = arrival.irradiance * phase(world.phase, -arrival.to_light, -ray.direction) *
                               std::exp(-light_depth) * scattering;
        if (seen.back()) value += lit;
        const double f = std::exp(-depth - extinction * h / 2);
        depth += extinction * h;
        result.radiance += f * h * (value.x + value.y + value.z);
        largest = std::max(largest, f * (value.x + value.y + value.z));
        if (seen != seen_before) ++changes;
        seen_before = seen;
    }
    result.error = changes * h * largest;
    return result;
}

double channels(glm::dvec3 v) { return v.x + v.y + v.z; }

TEST(Shafts, AgainstManySamples) {
    World world = propsWorld();
    std::mt19937 random(11);
    const auto unit = [&] { return random() / 4294967296.0; };
    for (const LightSource& light : allLights()) {
        world.lights = {light};
        double worst = 0;
        for (int i = 0; i < 4; ++i) {
            const Ray ray{{-7, 4 * unit() - 2, 6 * unit() - 3},
                          glm::normalize(glm::dvec3(1, unit() - 0.5, 0.6 * unit() - 0.3)),
                          0,
                          15};
            const double end = std::min(nearest(world.obstacles, ray).t, ray.end);
            const Brute brute = bruteForce(world, ray, end, 200'000);
            const double got = channels(along(world, ray).scattered);
            // Besides the jumps, midpoints of 0.07 mm: h^2/24 of a second derivative of some 1/k^2.
            EXPECT_NEAR(got, brute.radiance, brute.error + 1e-7 * got) << static_cast<int>(light.kind) << ' ' << i;
            EXPECT_LT(brute.error, 1e-4 * got);
            worst = std::max(worst, std::abs(got / brute.radiance - 1));
        }
        std::printf("light %d: 2e5 samples differ by at most %.1e\n", static_cast<int>(light.kind), worst);
    }
}

TEST(Faces, AgainstManySamples) {
    World world;
    world.blobs = cloud(6, 3, 3, 1.5, {0.9, 0.8, 0.7});
    world.support = Support::tetrahedron;
    for (const bool cut_light : {false, true}) {
        world.cut_light = cut_light;
        for (const LightSource& light : allLights()) {
            world.lights = {light};
            const Ray ray{{-5, 0.3, 0.2}, glm::normalize(glm::dvec3(1, -0.05, 0.03)), 0, 11};
            const Brute brute = bruteForce(world, ray, ray.end, 200'000);
            const double got = channels(along(world, ray).scattered);
            EXPECT_NEAR(got, brute.radiance, brute.error + 1e-7 * got)
                << static_cast<int>(light.kind) << ' ' << cut_light;
            EXPECT_LT(brute.error, 3e-3 * got);
            std::printf("faces, light %d, cut %d: %.1e\n", static_cast<int>(light.kind), cut_light,
                        got / brute.radiance - 1);
        }
    }
}

// What a hundredth of the tolerance changes is less than the tolerance, for every pixel and relative to the brightest.
void expectRefined(const char* what, const World& world, const Camera& camera, double tolerance) {
    Settings settings, fine;
    settings.tolerance = tolerance;
    fine.tolerance = tolerance / 100;
    const Picture coarse = render(world, camera, settings), better = render(world, camera, fine);
    double worst = 0, brightest = 0;
    for (size_t i = 0; i < coarse.radiance.size(); ++i) {
        worst = std::max(worst, std::abs(channels(coarse.radiance[i] - better.radiance[i])));
        worst =
            std::max(worst, std::abs(coarse.transmittance[i] - better.transmittance[i]) * channels(better.radiance[i]));
        brightest = std::max(brightest, channels(better.radiance[i]));
    }
    std::printf("%s: tolerance %g, the worst pixel changes by %.1e of the brightest\n", what, tolerance,
                worst / brightest);
    EXPECT_LT(worst, tolerance * brightest) << what;
    EXPECT_GT(brightest, 0);
}

TEST(Refinement, ChangesLessThanTheTolerance) {
    const Camera camera = perspective(brume::lookAt({-4, 2, 12}, {0, 0, 0}, 0.8f), 24, 14);
    World world = propsWorld();
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) expectRefined("props, three lights", world, camera, tolerance);
    world.obstacles.clear();
    world.fogs.clear();
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) expectRefined("cloud, three lights", world, camera, tolerance);
    world.support = Support::tetrahedron;
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) expectRefined("tetrahedra", world, camera, tolerance);
    world.composition = Composition::sequential;
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) expectRefined("tetrahedra one by one", world, camera, tolerance);
    world.composition = Composition::overlapping;
    world.cut_light = true;
    world.blobs.resize(5);
    expectRefined("tetrahedra that cut the light, too", world, camera, 1e-7);

    World balls; // depths of a union have roots at every silhouette, and kinks where balls meet that are not split
    balls.balls.sigma_t = 1.5;
    for (const Blob& b : cloud(8, 3, 1, 1, glm::dvec3(1))) balls.balls.balls.push_back({b.centre, b.scale});
    balls.lights = allLights();
    for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7})
        expectRefined("union of balls, its kinks found by halving", balls,
                      perspective(brume::lookAt({-4, 2, 12}, {0, 0, 0}, 0.4f), 16, 9), tolerance);
}

// Objects and rays against points along the ray that are inside or not.
TEST(Objects, AreHitWhereTheyBegin) {
    const World world = propsWorld();
    const auto inside = [](const Obstacle& o, glm::dvec3 x) {
        const glm::dvec3 d = x - o.centre;
        if (o.kind == Obstacle::Kind::plane) return d.y < 0;
        if (o.kind == Obstacle::Kind::sphere) return glm::length(d) < o.half_size.x;
        const double c = std::cos(o.yaw), s = std::sin(o.yaw);
        return std::abs(c * d.x - s * d.z) < o.half_size.x && std::abs(d.y) < o.half_size.y &&
               std::abs(s * d.x + c * d.z) < o.half_size.z;
    };
    std::mt19937 random(3);
    const auto unit = [&] { return random() / 2147483648.0 - 1; };
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
        const Ray ray{
            {6 * unit(), 5 + unit(), 6 * unit()}, glm::normalize(glm::dvec3(unit(), unit() - 0.5, unit())), 0, 12};
        const Hit hit = nearest(world.obstacles, ray);
        const double step = 0.004;
        double met = kInfinity;
        for (double t = step; t < ray.end && std::isinf(met); t += step)
            for (const Obstacle& o : world.obstacles)
                if (inside(o, ray.at(t))) met = t;
        EXPECT_LE(hit.t, met) << "something is missed";
        EXPECT_EQ(occluded(world.obstacles, ray), hit.t < ray.end);
        if (std::isinf(hit.t)) continue;
        ++hits;
        ASSERT_LT(glm::dot(hit.normal, ray.direction), 0);
        ASSERT_NEAR(glm::length(hit.normal), 1, 1e-12);
        ASSERT_FALSE(inside(world.obstacles[hit.object], ray.at(hit.t) + 1e-9 * hit.normal));
        ASSERT_TRUE(inside(world.obstacles[hit.object], ray.at(hit.t) - 1e-9 * hit.normal));
    }
    EXPECT_GT(hits, 700);
}

// Ground under a medium, an object and the sky: Lambert's law, piece by piece.
TEST(Surface, LightAndSky) {
    World world;
    world.obstacles = {{Obstacle::Kind::plane, {0, 0, 0}, glm::dvec3(0), 0, glm::dvec3(0.4)}};
    world.sky_horizon = glm::dvec3(0.2);
    world.sky_zenith = glm::dvec3(0.6);
    const Ray down{{0, 5, 0}, {0, -1, 0}};
    // Of the zenith, 2 times the integral of cosine and part over the cosine from 0 to 1: 0.82774.
    EXPECT_NEAR(along(world, down).total().x, 0.4 * (0.2 + 0.4 * 0.82774), 0.4 * 0.4 * 0.0012);
    world.sky_horizon = world.sky_zenith = glm::dvec3(0.4);
    EXPECT_NEAR(along(world, down).total().x, 0.4 * 0.4, 1e-15) << "the same from everywhere";
    world.lights = {distant({0.6, 0.8, 0}, 3)};
    EXPECT_NEAR(along(world, down).total().x, 0.4 * (0.4 + 3 * 0.8 / kPi), 1e-15);
    world.blobs = {blob({6, 8, 0}, 1, 1.6, 1.3)}; // in the light's way, not in the view's
    EXPECT_NEAR(along(world, down).total().x, 0.4 * (0.4 + 3 * 0.8 / kPi * std::exp(-1.3)), 1e-9);
    world.obstacles.push_back({Obstacle::Kind::sphere, {3, 4, 0}, glm::dvec3(0.5), 0, glm::dvec3(1)});
    EXPECT_NEAR(along(world, down).total().x, 0.4 * 0.4, 1e-15);
    world.lights = {LightSource{Kind::point, glm::dvec3(3), {}, {0, 2, 0}}};
    EXPECT_NEAR(along(world, down).total().x, 0.4 * (0.4 + 3 / 4.0 / kPi), 1e-12);
    // The sky itself: horizon below -0.15, zenith above 0.85.
    world.sky_horizon = glm::dvec3(0.2);
    world.sky_zenith = glm::dvec3(0.6);
    EXPECT_EQ(skyRadiance(world, glm::normalize(glm::dvec3(1, -0.3, 0))).x, 0.2);
    EXPECT_NEAR(skyRadiance(world, {std::sqrt(1 - 0.35 * 0.35), 0.35, 0}).x, 0.4, 1e-15);
    EXPECT_NEAR(along(world, {{0, 5, 0}, {0, 1, 0}}).total().x, 0.6, 1e-15);
    world.haze = 0.1; // 1/m; the ray crosses 5 m of it
    const double ground = 0.4 * (0.2 + 0.4 * brume::physics::skyZenithSeen(1.0) + 3 / 4.0 / kPi);
    EXPECT_NEAR(along(world, down).total().x, 0.2 + (ground - 0.2) * std::exp(-0.5), 1e-12);
    EXPECT_NEAR(along(world, {{0, 5, 0}, {0, 1, 0}}).total().x, 0.6, 1e-15) << "the sky is behind all air";
}

} // namespace

// A medium of tetrahedra: exact answers, the same medium cut up in other ways, and sums of many samples straight from
// the definition.
#include "tools/reference/tetrahedra.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "common/tetrahedra.h"
#include "tests/reference/test_media.h"
#include "tools/reference/medium_reference.h"
#include "tools/reference/tracker.h"

namespace {

using namespace brume::reference;
using namespace brume::reference::test;
using Corner = TetrahedralMedium::Corner;
using Kind = LightSource::Kind;

double linear(glm::dvec3 x) { return 0.3 + glm::dot(glm::dvec3(0.5, 0.2, 0.4), x); }

std::vector<TetrahedralMedium> cubes(const Field& sigma) {
    return {fiveInACube(sigma), cube(1, 0, sigma), cube(2, 0, sigma), cube(3, 0.15, sigma)};
}

World worldWith(TetrahedralMedium medium, std::vector<LightSource> lights = {}) {
    World world;
    world.tetrahedra = std::move(medium);
    world.lights = std::move(lights);
    return world;
}

std::vector<LightSource> pointAndSpot() {
    LightSource point, spot;
    point.kind = Kind::point;
    point.position = {2, 5, 3};
    point.colour = glm::dvec3(60);
    spot.kind = Kind::spot;
    spot.position = {-2, 4, 2};
    spot.axis = glm::normalize(glm::dvec3(0.6, -0.7, -0.2));
    spot.colour = glm::dvec3(90);
    spot.cos_outer = std::cos(0.6);
    spot.cos_inner = std::cos(0.3);
    return {distant({0.5, 1, 0.2}, 3), point, spot};
}

double transmittance(const TetrahedralMedium& medium, const Ray& ray) {
    return std::exp(-TetrahedraTree(medium).depth(ray));
}

Ray through(glm::dvec3 from, glm::dvec3 to) { return {from, glm::normalize(to - from)}; }

void expectRelative(double got, double exact, double most = 1e-9) { EXPECT_NEAR(got / exact, 1, most); }

TEST(Tetrahedra, OfOneExtinctionAreABox) {
    for (const double depth : {1e-3, 0.1, 3.0, 50.0, 1e3}) {
        const double sigma = depth / kSide;
        for (const TetrahedralMedium& medium : cubes(even(sigma))) {
            World world = worldWith(medium, {distant({-1, 0, 0})});
            const Ray ray{{-1, 0.7, 1.1}, {1, 0, 0}};
            const RayResult front = along(world, ray);
            EXPECT_NEAR(front.transmittance, std::exp(-depth), 1e-12);
            expectRelative(front.scattered.x, -std::expm1(-2 * depth) / 2 / (4 * kPi));
            world.lights = {distant({0, 1, 0})};
            expectRelative(along(world, ray).scattered.x,
                           std::exp(-sigma * (kSide - 0.7)) * -std::expm1(-depth) / (4 * kPi));
            if (depth > 500) continue; // nothing comes through
            world.lights = {distant({1, 0, 0})};
            expectRelative(along(world, ray).scattered.x, depth * std::exp(-depth) / (4 * kPi));
        }
    }
}

// Light that comes down aslant enters through the top or through the side that is behind: the depth has a kink.
TEST(Tetrahedra, LightHasAKinkWhereItEntersThroughAnotherFace) {
    const double sigma = 0.8, y = 0.7, slope = 1.3, per = std::sqrt(1 + slope * slope); // m of light's way per m of y
    for (const TetrahedralMedium& medium : cubes(even(sigma))) {
        const World world = worldWith(medium, {distant({slope, 1, 0})});
        const double got = along(world, {{-1, y, 1.1}, {1, 0, 0}}).scattered.x;
        const double kink = kSide - slope * (kSide - y), top = std::exp(-sigma * per * (kSide - y));
        ASSERT_GT(kink, 0.1);
        // Behind it, the light's way is (kSide - x) * per / slope.
        const double rate = sigma * (per / slope - 1);
        const double side =
            std::exp(-sigma * per / slope * kSide) * sigma * (std::exp(rate * kSide) - std::exp(rate * kink)) / rate;
        expectRelative(got, (top * -std::expm1(-sigma * kink) + side) / (4 * kPi));
    }
}

TEST(Tetrahedra, LinearExtinctionIsExact) {
    for (const TetrahedralMedium& medium : cubes(linear)) {
        const Ray ray = through({-1, 0.2, 0.4}, {3, 1.7, 1.5});
        const glm::dvec3 in = ray.at(-ray.origin.x / ray.direction.x),
                         out = ray.at((kSide - ray.origin.x) / ray.direction.x);
        const double depth = glm::distance(in, out) * linear((in + out) / 2.0);
        expectRelative(TetrahedraTree(medium).depth(ray), depth, 1e-13);
        // Light from the eye has the view's own depth, whatever the extinction is on the way.
        const World world = worldWith(medium, {distant(-ray.direction)});
        expectRelative(along(world, ray).scattered.x, -std::expm1(-2 * depth) / 2 / (4 * kPi));
    }
}

TEST(Tetrahedra, EyeInside) {
    const double sigma = 0.9;
    for (const TetrahedralMedium& medium : cubes(even(sigma))) {
        const World world = worldWith(medium, {distant({1, 0, 0})});
        const double length = kSide - 0.8, depth = sigma * length;
        const RayResult result = along(world, {{0.8, 0.7, 1.1}, {1, 0, 0}});
        EXPECT_NEAR(result.transmittance, std::exp(-depth), 1e-12);
        expectRelative(result.scattered.x, depth * std::exp(-depth) / (4 * kPi));
    }
    const World world = worldWith(cube(3, 0.15, linear), {distant({1, 2, 3})});
    Ray whole = through({-1, 0.2, 0.4}, {3, 1.7, 1.5}), near = whole, far = whole;
    near.end = far.begin = 2.2;
    const RayResult all = along(world, whole), before = along(world, near), behind = along(world, far);
    expectRelative(before.transmittance * behind.transmittance, all.transmittance, 1e-12);
    expectRelative(before.scattered.x + before.transmittance * behind.scattered.x, all.scattered.x, 1e-7);
}

// Rays in faces, along edges and through corners lose nothing and have nothing twice.
TEST(Tetrahedra, RaysAlongFacesAndEdges) {
    const TetrahedralMedium regular = cube(4, 0, linear);
    const auto depthOf = [](glm::dvec3 in, glm::dvec3 out) {
        return glm::distance(in, out) * linear((in + out) / 2.0);
    };
    const auto expectDepth = [&](glm::dvec3 in, glm::dvec3 out) {
        const glm::dvec3 by = 3.0 * (out - in);
        expectRelative(TetrahedraTree(regular).depth(through(in - by, out)), depthOf(in, out), 1e-12);
    };
    for (int i = 1; i < 4; ++i)
        for (int j = 1; j < 4; ++j) { // along edges of small cubes
            expectDepth({0, 0.5 * i, 0.5 * j}, {kSide, 0.5 * i, 0.5 * j});
            expectDepth({0.5 * i, kSide, 0.5 * j}, {0.5 * i, 0, 0.5 * j});
            expectDepth({0.5 * i, 0.5 * j, 0}, {0.5 * i, 0.5 * j, kSide});
        }
    expectDepth({0, 0, 0}, {kSide, kSide, kSide}); // along the small cubes' longest edges
    expectDepth({0, 0.5, 0}, {1.5, kSide, 1.5});
    expectDepth({0, 1, 0}, {kSide, 1, kSide}); // along diagonals of their faces
    expectDepth({0, 0, 1.5}, {kSide, kSide, 1.5});
    expectDepth({0, 1, 0.3}, {kSide, 1, 1.9}); // in their faces
    expectDepth({0.3, 0.3, 0}, {1.9, 1.9, kSide});

    // From a corner to another of the same tetrahedron and on, in a mesh without any order.
    const TetrahedralMedium moved = cube(4, 0.15, linear);
    const TetrahedraTree tree(moved);
    const auto depth = [&](glm::dvec3 from, glm::dvec3 to) { return tree.depth(through(from, to)); };
    std::mt19937 random(8);
    int tried = 0;
    constexpr double kOff = 1e-10; // m; a ray that grazes the outside gets longer by many times that
    for (const glm::uvec4& cell : moved.cells) {
        const glm::dvec3 a = moved.corners[cell[0]].place, b = moved.corners[cell[3]].place;
        glm::dvec3 off; // drawn in one order, whatever the compiler
        off.x = kOff * (random() % 3 - 1.0), off.y = kOff * (random() % 2 - 0.5), off.z = kOff * (random() % 2 - 0.5);
        const auto within = [](glm::dvec3 x) {
            return glm::all(glm::greaterThan(x, glm::dvec3(0.01))) &&
                   glm::all(glm::lessThan(x, glm::dvec3(kSide - 0.01)));
        };
        if (!within((a + b) / 2.0)) continue; // an edge of the outside may be met or missed
        ++tried;
        const glm::dvec3 from = a - 1.7 * (b - a), aside = glm::dvec3(0.3, -5, 2.2);
        EXPECT_NEAR(depth(from, b), depth(from + off, b + off), 1e-7) << "along an edge";
        if (!within(a)) continue;
        EXPECT_NEAR(depth(aside, a), depth(aside, a + off), 1e-7) << "through a corner";
        EXPECT_NEAR(depth(aside, (a + b) / 2.0), depth(aside, (a + b) / 2.0 + off), 1e-7) << "through an edge";
        for (int i = 0; i < 30; ++i) { // some have a side that rounding would turn
            const double part = random() / 4294967296.0, share = random() / 4294967296.0;
            const glm::dvec3 in = glm::mix(a, moved.corners[cell[1]].place, part), by = glm::mix(a, b, share) - in;
            EXPECT_NEAR(depth(in - 9.0 * by, in), depth(in - 9.0 * by + off, in + off), 1e-7) << "in a face";
        }
    }
    EXPECT_GT(tried, 200);

    std::vector<CellPart> parts;
    tree.along(through({-1, 0.3, 0.2}, {3, 1.8, 1.6}), parts);
    ASSERT_GT(parts.size(), 8);
    for (size_t i = 0; i + 1 < parts.size(); ++i) EXPECT_EQ(parts[i].end, parts[i + 1].begin) << i;
}

// The definition: a point is inside where its barycentric coordinates are positive; the light leaves where bisection
// says so.
TEST(Tetrahedra, OneAgainstManySamples) {
    const std::vector<Corner> corners{{{0, 0, 0}, 0.1, {0.9, 0.8, 0.1}},
                                      {{2, 0.2, 0.1}, 3, {0.2, 0.9, 0.5}},
                                      {{0.4, 1.8, 0.3}, 0, {0.5, 0.1, 0.9}},
                                      {{0.6, 0.3, 1.5}, 1.2, {1, 1, 1}}};
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(corners[1].place, corners[2].place, corners[3].place));
    const auto coordinates = [&](glm::dvec3 x) {
        const glm::dvec3 c = inverse * x;
        return glm::dvec4(1 - c.x - c.y - c.z, c);
    };
    const auto inside = [&](glm::dvec3 x) {
        const glm::dvec4 c = coordinates(x);
        return std::min({c.x, c.y, c.z, c.w}) > 0;
    };
    const auto extinction = [&](glm::dvec3 x) {
        double sum = 0;
        for (int i = 0; i < 4; ++i) sum += coordinates(x)[i] * corners[size_t(i)].sigma_t;
        return sum;
    };
    // Distance at which the ray from x, which is inside, leaves.
    const auto leaves = [&](glm::dvec3 x, glm::dvec3 w) {
        double in = 0, out = 4;
        for (int i = 0; i < 60; ++i) (inside(x + (in + out) / 2 * w) ? in : out) = (in + out) / 2;
        return in;
    };
    const glm::dvec3 middle(0.7, 0.5, 0.45);
    ASSERT_TRUE(inside(middle));
    const TetrahedralMedium medium{corners, {{2, 0, 3, 1}}};
    for (const LightSource& light : pointAndSpot()) {
        World world = worldWith(medium, {light});
        world.phase = {0.6, 0.5};
        world.ambient = {0.02, 0.03, 0.04};
        const Ray ray = through({-2, 1, 1.2}, middle);
        const double centre = glm::distance(ray.origin, middle);
        const double t0 = centre - leaves(middle, -ray.direction), t1 = centre + leaves(middle, ray.direction);
        const int samples = 100'000;
        const double h = (t1 - t0) / samples;
        double depth = 0;
        glm::dvec3 sum(0);
        for (int i = 0; i < samples; ++i) {
            const glm::dvec3 x = ray.at(t0 + (i + 0.5) * h);
            const glm::dvec4 c = coordinates(x);
            glm::dvec3 albedo(0);
            for (int j = 0; j < 4; ++j) albedo += c[j] * corners[size_t(j)].albedo;
            const Arrival arrival = arrivalAt(light, x);
            const double way = std::min(leaves(x, arrival.to_light), arrival.distance);
            const double dims = std::exp(-way * extinction(x + way / 2 * arrival.to_light));
            const double sigma = extinction(x);
            sum += h * std::exp(-depth - sigma * h / 2) * sigma * albedo *
                   (arrival.irradiance * dims * phase(world.phase, -arrival.to_light, -ray.direction) + world.ambient);
            depth += sigma * h;
        }
        const RayResult got = along(world, ray);
        expectRelative(got.transmittance, std::exp(-depth), 1e-8);
        for (int c = 0; c < 3; ++c) expectRelative(got.scattered[c], sum[c], 2e-8);
    }
}

// A linear extinction is the same medium whatever the tetrahedra: 6 or 1296.
TEST(Tetrahedra, CutUpAnotherWayAreTheSame) {
    const TetrahedralMedium few = cube(1, 0, linear), many = cube(6, 0.15, linear);
    const glm::dvec3 eye(-2, 1.5, 4);
    for (const LightSource& light : pointAndSpot())
        for (const glm::dvec3 to : {glm::dvec3(1, 1, 1), glm::dvec3(0.3, 0.4, 0.5), glm::dvec3(1.2, 0.1, 1.9)}) {
            const RayResult a = along(worldWith(few, {light}), through(eye, to)),
                            b = along(worldWith(many, {light}), through(eye, to));
            expectRelative(b.transmittance, a.transmittance, 1e-13);
            expectRelative(b.scattered.x, a.scattered.x, 1e-7);
        }
}

// What a thousandth of the tolerance changes is less than the tolerance, although no panel ends at edges on the inside.
TEST(Tetrahedra, ConvergeWithKinksInside) {
    std::mt19937 random(9);
    const World world = worldWith(
        cube(5, 0.15, [&](glm::dvec3) { return 3 * (random() / 4294967296.0); }, {0.9, 0.6, 0.3}), pointAndSpot());
    ASSERT_GT(world.tetrahedra.cells.size(), 500);
    const Camera camera = perspective(brume::lookAt({-2, 1.5, 4}, {1, 1, 1}, 0.6f), 8, 6);
    Settings settings;
    settings.tolerance = 1e-8;
    const Picture fine = render(world, camera, settings);
    double brightest = 0;
    for (const glm::dvec3 pixel : fine.radiance) brightest = std::max(brightest, pixel.x);
    for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
        settings.tolerance = tolerance;
        const Picture coarse = render(world, camera, settings);
        double worst = 0;
        for (size_t i = 0; i < fine.radiance.size(); ++i)
            worst = std::max(worst, std::abs(coarse.radiance[i].x - fine.radiance[i].x));
        std::printf("tetrahedra: tolerance %g, the worst pixel changes by %.1e of the brightest\n", tolerance,
                    worst / brightest);
        EXPECT_LT(worst, tolerance * brightest);
    }
}

TEST(Tetrahedra, WhereADepthIsReached) {
    for (const auto& [from, to] : {std::pair{0.5, 2.0}, {2.0, 0.5}, {0.0, 1.0}, {1.0, 0.0}, {1.0, 1.0}}) {
        const CellPart part{1, 3, {from, to}};
        for (const double depth : {0.01, 0.4, 0.99})
            expectRelative(part.depthTo(part.whereDepthIs(depth)), depth, 1e-13);
        EXPECT_EQ(part.whereDepthIs(from + to), kInfinity);
    }
}

TEST(Tetrahedra, ExtinctionOfColours) {
    World world = worldWith(cube(2, 0.15, even(0.8)), {distant({-1, 0, 0})});
    world.extinction_colour = {1, 0.5, 0.25};
    const RayResult result = along(world, {{-1, 0.7, 1.1}, {1, 0, 0}});
    double mean = 0;
    for (int c = 0; c < 3; ++c) {
        const double depth = 0.8 * kSide * world.extinction_colour[c];
        expectRelative(result.scattered[c], -std::expm1(-2 * depth) / 2 / (4 * kPi));
        mean += std::exp(-depth) / 3;
    }
    expectRelative(result.transmittance, mean);
}

TEST(Tetrahedra, ObjectInside) {
    const double sigma = 0.8;
    for (const TetrahedralMedium& medium : cubes(even(sigma))) {
        World world = worldWith(medium, {distant({0, 1, 0})});
        world.obstacles = {{Obstacle::Kind::box, {1, 1.5, 1}, {0.3, 0.1, 0.3}, 0, glm::dvec3(0)}};
        // Its shadow is on the ray from 0.7 to 1.3.
        const double lit = -std::expm1(-sigma * kSide) - std::exp(-sigma * 0.7) + std::exp(-sigma * 1.3);
        expectRelative(along(world, {{-1, 0.7, 1.1}, {1, 0, 0}}).scattered.x,
                       std::exp(-sigma * (kSide - 0.7)) * lit / (4 * kPi));
        const RayResult met = along(world, {{-1, 1.5, 1.1}, {1, 0, 0}});
        EXPECT_NEAR(met.transmittance, std::exp(-sigma * 0.7), 1e-12);
        expectRelative(met.scattered.x, std::exp(-sigma * 0.5) * -std::expm1(-sigma * 0.7) / (4 * kPi));
    }
}

TEST(Tetrahedra, ShadowOtherMediaUnlessTheLightHasNoShadows) {
    World world = worldWith(cube(2, 0.15, even(0.8)), pointAndSpot());
    world.lights = {world.lights[1]};
    world.lights[0].position = {1, 5, 1};
    const Ray ray{{1, -1, -20}, {0, 0, 1}};
    world.fogs = {{0.01}};
    world.fogs[0].hi = -0.5;
    const double shadowed = along(world, ray).scattered.x;
    world.lights[0].shadows = false;
    const double lit = along(world, ray).scattered.x;
    world.tetrahedra = {};
    expectRelative(along(world, ray).scattered.x, lit, 1e-7);
    EXPECT_LT(shadowed, 0.9 * lit);
}

TEST(Tetrahedra, AreNothingOutside) {
    const World world = worldWith(cube(2, 0.15, even(0.8)), pointAndSpot());
    for (const Ray& ray :
         {Ray{{-1, 2.1, 1}, {1, 0, 0}}, Ray{{-1, 1, 1}, {-1, 0, 0}}, Ray{{-1, 1, 1}, {1, 0, 0}, 0, 0.9}}) {
        EXPECT_EQ(along(world, ray).transmittance, 1);
        EXPECT_EQ(along(world, ray).scattered, glm::dvec3(0));
    }
}

TEST(Tetrahedra, ThatAreFlatAreNothingAndThatOverlapAddUp) {
    const Ray ray{{-1, 0.7, 1.1}, {1, 0, 0}};
    TetrahedralMedium medium = cube(2, 0.15, linear);
    const double once = TetrahedraTree(medium).depth(ray);
    const size_t cells = medium.cells.size();
    for (size_t i = 0; i < cells; ++i) medium.cells.push_back(medium.cells[i]);
    expectRelative(TetrahedraTree(medium).depth(ray), 2 * once, 1e-13);
    EXPECT_EQ(transmittance(
                  {{{{0, 0, 0}, 1, {}}, {{1, 2, 0}, 1, {}}, {{1, 0, 2}, 1, {}}, {{2, 2, 2}, 1, {}}}, {{0, 1, 2, 3}}},
                  {{0.9, 0.9, -1}, {0, 0, 1}}),
              1);
}

TEST(Tetrahedra, OfAScene) {
    brume::Scene scene;
    scene.medium.model = brume::kTetrahedraMedium;
    scene.medium.extinction_colour = {1, 0.5, 0.5};
    brume::Tetrahedra mesh;
    mesh.corners = {{0, 1, 2, 3}};
    scene.tetrahedra = std::make_shared<brume::Tetrahedra>(mesh);
    std::vector<brume::gpu::Particle> particles(4);
    for (int i = 0; i < 3; ++i) particles[size_t(i)].centre[i] = 3;
    for (auto& particle : particles) particle.sigma_t = 0.5, particle.albedo = glm::vec3(0.25);
    const World world = worldOf(scene, particles);
    EXPECT_TRUE(world.blobs.empty() && world.balls.balls.empty());
    EXPECT_TRUE(isColoured(world));
    const Ray ray = through({5, 5, 5}, {0, 0, 0}); // √3 m from the face to the corner
    expectRelative(TetrahedraTree(world.tetrahedra).depth(ray), 0.5 * std::sqrt(3));
    expectRelative(TetrahedraTree(inChannel(world, 1).tetrahedra).depth(ray), 0.25 * std::sqrt(3));
    EXPECT_EQ(world.tetrahedra.corners[2].albedo, glm::dvec3(0.25));
}

TEST(Tetrahedra, FirstOrderOfRandomPathsIsSingleScattering) {
    World world = worldWith(cube(3, 0.15, linear, {0.9, 0.6, 0.3}), pointAndSpot());
    world.fogs = {{0.05, glm::dvec3(0.5)}};
    world.obstacles = {{Obstacle::Kind::box, {1, 1.5, 1}, {0.3, 0.1, 0.3}, 0, glm::dvec3(0)}}; // black: no light back
    const Camera camera = perspective(brume::lookAt({-2, 1.5, 4}, {1, 1, 1}, 0.6f), 4, 3);
    TrackSettings settings;
    settings.samples = 20'000;
    settings.orders = 1;
    const TrackedPicture paths = track(world, camera, settings);
    const std::vector<glm::dvec3> exact = render(world, camera).total();
    for (size_t i = 0; i < exact.size(); ++i) {
        ASSERT_LT(paths.standard_error[i].x, 0.05 * exact[i].x);
        EXPECT_NEAR(paths.radiance[i].x, exact[i].x, 4.5 * paths.standard_error[i].x) << i;
    }
}

TEST(Tetrahedra, AreNotCompositedOneByOne) {
    World world = worldWith(cube(1, 0, even(1)));
    world.composition = Composition::sequential;
    EXPECT_THROW(along(world, {{-1, 0.7, 1.1}, {1, 0, 0}}), std::invalid_argument);
}

} // namespace

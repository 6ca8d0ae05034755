// Method grid: what is sampled from its nodes against exact Gaussians, convergence with the spacing, independence of
// viewers, what it refuses.
#include <algorithm>
#include <cmath>

#include "server/methods/grid/medium_grid.h"
#include "tests/gpu/closed_form.h"
#include "tests/layer.h"

namespace brume::test::grid_test {
namespace {

constexpr uint32_t kWidth = 70, kHeight = 45; // no multiple of a tile's

double spline(double t) { // cubic B-spline
    t = std::abs(t);
    return t < 1 ? (4 - 6 * t * t + 3 * t * t * t) / 6 : t < 2 ? std::pow(2 - t, 3) / 6 : 0;
}
double triangle(double t) { return std::max(0.0, 1 - std::abs(t)); }

// Largest error of a Gaussian of standard deviation 1 and peak 1 that nodes `h` apart hold, wherever it lies among
// them.
double largestError(double h, bool cubic) {
    const double held = 1 - h * h / (cubic ? 3 : 6), peak = 1 / std::sqrt(held);
    double worst = 0;
    for (double offset = 0; offset < 1; offset += 1.0 / 16)
        for (double x = -5; x < 5; x += 0.01) {
            const double at = x / h - offset;
            double sum = 0;
            for (int j = int(std::floor(at)) - 1; j <= int(std::floor(at)) + 2; ++j) {
                const double node = (j + offset) * h;
                sum += peak * std::exp(-node * node / (2 * held)) * (cubic ? spline(at - j) : triangle(at - j));
            }
            worst = std::max(worst, std::abs(sum - std::exp(-x * x / 2)));
        }
    return worst;
}

// The same, of coarse nodes 2 h apart, from which a B-spline makes those that are sampled linearly.
double largestCoarseError(double h) {
    const double held = 1 - h * h / 6 - 4 * h * h / 3, peak = 1 / std::sqrt(held);
    double worst = 0;
    for (double offset = 0; offset < 1; offset += 1.0 / 16) {
        const auto coarse = [&](int j) {
            const double node = (j + offset) * 2 * h;
            return peak * std::exp(-node * node / (2 * held));
        };
        const auto fine = [&](int i) { // at 2 h (offset + i / 2)
            double sum = 0;
            for (int j = i / 2 - 3; j <= i / 2 + 3; ++j) sum += coarse(j) * spline(0.5 * i - j);
            return sum;
        };
        for (double x = -5; x < 5; x += 0.01) {
            const double at = x / h - 2 * offset;
            const int i = int(std::floor(at));
            const double t = at - i;
            worst = std::max(worst, std::abs((1 - t) * fine(i) + t * fine(i + 1) - std::exp(-x * x / 2)));
        }
    }
    return worst;
}

// As server/methods/grid/node_grid_plan.h states, in double precision.
TEST(GridSampling, ErrsByTheStatedPowersOfTheSpacing) {
    for (const double h : {0.08, 0.15, 0.25, 0.35, 0.5, 0.7}) {
        EXPECT_LT(largestError(h, false), h * h / 11) << h;
        EXPECT_GT(largestError(h, false), h * h / 14) << h;
        EXPECT_LT(largestError(h, true), std::pow(h, 4) / 85) << h;
        EXPECT_GT(largestError(h, true), std::pow(h, 4) / 140) << h;
    }
    for (const double h : {0.08, 0.15, 0.25, 0.35, 1 / double(kLeastCoarse)}) {
        EXPECT_LT(largestCoarseError(h), h * h / 11 + std::pow(2 * h, 4) / 85) << h;
        EXPECT_GT(largestCoarseError(h), h * h / 14) << h;
    }
}

class GridTest : public GpuTest {
protected:
    static Picture see(Scene scene, const Pose& pose, float spacing, const char* method = "grid") {
        scene.render.method = method;
        scene.render.rate = 1;
        scene.render.slabs = 128;
        scene.render.grid.spacing = spacing;
        return plain().see(scene, pose, kWidth, kHeight);
    }
};

// One particle, its place among the nodes at random; a line of sight errs along two axes at most.
TEST_F(GridTest, OneParticleConvergesToItsClosedForm) {
    Random random(3);
    for (const float spacing : {0.7f, 0.5f, 0.35f, 0.25f, 0.2f, 0.1f}) {
        double error = 0;
        for (int i = 0; i < 4; ++i) {
            const Point point = thick(random.inCube(0.5f), 2, 1, 0.3f);
            const Scene scene = sceneOf({point}, 0.3f);
            const Pose pose = lookAt(point.centre + 3.0f * random.direction(), point.centre, 0.3f);
            const reference::Blob blob = blobsOf(scene)[0];
            const Picture picture = see(scene, pose, spacing);
            for (uint32_t y = 0; y < kHeight; ++y)
                for (uint32_t x = 0; x < kWidth; ++x) {
                    const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
                    error = std::max(
                        error, std::abs(double(picture.at(x, y).a) - std::exp(-depthOn(blob, ray, wholeRay(ray)))));
                }
        }
        const double h = double(spacing), one_axis = h < double(kCubicBelow) ? std::pow(h, 4) / 85 : h * h / 11;
        EXPECT_LT(error, 2 * one_axis / std::exp(1.0) + 4e-6) << h; // tau T <= 1 / e; float, cut-off
        EXPECT_GT(error, h < 0.5 ? 0 : 0.02 * one_axis) << h << ": too good to be this spacing";
    }
}

// Larger and smaller ones, of one albedo and of many: the same picture as the slabs that every viewer sums for itself.
TEST_F(GridTest, ManyParticlesAreThoseOfSlabs) {
    Random random(9);
    std::vector<Point> points = randomPoints(300, 8, 2.5f, 0.5f, 4);
    for (Point& p : points) {
        p.albedo = glm::vec3(0.5f) + random.inCube(0.5f);
        p.scale = random.uniform(2.5f, 4);
    }
    for (const bool coloured : {true, false}) {
        if (!coloured)
            for (Point& p : points) p.albedo = {0.9f, 0.6f, 0.3f};
        const Scene scene = sceneOf(points, 1.6f);
        for (const Pose& pose : {lookAt({0, 2, 20}, {0, 0, 0}, 0.7f), lookAt({1, 0, 2}, {-1, 0, 0}, 1.2f),
                                 lookAt({0.3f, 0.2f, 0}, {0, 0, 1}, 2), lookAt({300, 200, 700}, {0, 0, 0}, 0.02f)}) {
            const Picture exact = see(scene, pose, 0, "slabs");
            for (const float spacing : {0.5f, 0.2f}) {
                const Picture grid = see(scene, pose, spacing);
                double squares = 0, errors = 0;
                for (size_t i = 0; i < grid.pixels.size(); ++i)
                    for (int c = 0; c < 3; ++c) {
                        squares += std::pow(double(exact.pixels[i][c]), 2);
                        errors += std::pow(double(grid.pixels[i][c]) - double(exact.pixels[i][c]), 2);
                    }
                ASSERT_GT(squares, 0.01);
                // What server/plan expects of pictures where sampling is linear; where it is cubic, a tenth of what one
                // axis of the smallest particles errs by, h = 0.26 of theirs, is too little to tell from float at 800
                // m.
                EXPECT_LT(std::sqrt(errors / squares), spacing > 0.4f ? 3e-3 : 5e-5)
                    << pose.position.x << ' ' << coloured;
            }
        }
    }
}

// What one viewer sees does not depend on who else looks, nor on what was rendered before: bit for bit.
TEST_F(GridTest, ViewersAndHistoryChangeNothing) {
    const Scene one = sceneOf(randomPoints(200, 8, 2, 0.7f, 1), 1.6f);
    Scene scene = one;
    scene.render.method = "grid";
    Renderer renderer(device(), scene, 600);
    renderer.keepRadiance(true);
    Submission submission(device(), "grid");
    const Simulation simulation(scene);
    const EyeRequest eye{lookAt({0, 2, 12}, {0, 0, 0}, 0.8f), kWidth, kHeight},
        other{lookAt({3, 0, 1}, {0, 0, 0}, 1.2f), 2 * kWidth, kHeight};
    const auto seen = [&](std::vector<EyeRequest> eyes) {
        submitAndWait(renderer, submission, simulation, eyes);
        return renderer.readRadiance();
    };
    const std::vector<glm::vec4> alone = seen({eye});
    EXPECT_EQ(alone, seen({other, eye}));
    EXPECT_EQ(alone, seen({other, other, other, eye}));
    EXPECT_EQ(alone, seen({eye})); // of a medium that rests
    renderer.forget();
    EXPECT_EQ(alone, seen({eye}));

    // Another method between, and another medium: the grid is that of the particles that are there.
    Stage stage(device(), scene, 600);
    Scene moved = sceneOf(randomPoints(150, 7, 2, 0.9f, 2), 1.6f), drawn = moved;
    moved.render.method = "grid";
    drawn.render.method = "sphere";
    const Picture first = stage.see(scene, eye.pose, kWidth, kHeight);
    EXPECT_EQ(first.pixels, alone);
    stage.see(drawn, eye.pose, kWidth, kHeight);
    const Picture then = stage.see(moved, eye.pose, kWidth, kHeight);
    EXPECT_EQ(then.pixels, render(device(), moved, eye.pose, kWidth, kHeight).pixels);
    EXPECT_NE(then.pixels, first.pixels);
}

// Sparse: two heaps far apart, nothing between them is written, and nothing of what lay there before is seen.
TEST_F(GridTest, EmptyBricksAreEmpty) {
    std::vector<Point> points = randomPoints(200, 10, 1.5f, 1.5f, 5), heaps;
    for (int i = 0; i < 60; ++i)
        heaps.push_back({points[i].centre * 0.1f + glm::vec3(i % 2 ? 4.5f : -4.5f), 1.5f, 0.5f});
    const Pose pose = lookAt({0, 3, 16}, {0, 0, 0}, 0.9f);
    see(sceneOf(points, 1.6f), pose, 0.3f); // fills bricks
    const Scene scene = sceneOf(heaps, 1.6f);
    const Picture grid = see(scene, pose, 0.3f), exact = see(scene, pose, 0, "slabs");
    int clear = 0;
    for (size_t i = 0; i < grid.pixels.size(); ++i) {
        EXPECT_NEAR(grid.pixels[i].a, exact.pixels[i].a, 4e-3) << i; // (0.3)^2 / 11 of a depth of 1 and more
        clear += grid.pixels[i].a > 1 - 1e-6f;
    }
    EXPECT_GT(clear, 300);
}

// The first, the last but one and the last of a million, all others faint in a heap: each is where it was put, and no
// part of the heap is lost.
TEST_F(GridTest, AMillionParticles) {
    BRUME_WHOLE_LAYER_ONLY();
    constexpr uint32_t kCount = 1'000'000;
    const glm::vec3 places[] = {{-2, 1, 0}, {2, 1, 0}, {-2, -1, 0}};
    std::vector<Point> points{thick(places[0], 1, 1, 1.6f)};
    Random random(1);
    while (points.size() < kCount - 2) points.push_back(thick(random.inCube(0.5f), 1, 1e-6, 1.6f));
    points.push_back(thick(places[1], 1, 1, 1.6f));
    points.push_back(thick(places[2], 1, 1, 1.6f));
    Scene scene = sceneOf(points, 1.6f);
    scene.render.method = "grid";
    scene.render.shadow_size = 16;
    scene.render.shadow_slices = 2;
    const Pose pose = lookAt({0, 0, 9}, {0, 0, 0}, 0.5f);
    const Picture picture = render(device(), scene, pose, kWidth, kHeight);
    const auto blobs = blobsOf(scene);
    const float pixels = 0.5f * kHeight / (9 * std::tan(0.25f)); // to a metre
    for (const glm::vec3 place :
         {places[0], places[1], places[2], glm::vec3(0), glm::vec3(0.4f, 0.3f, 0), glm::vec3(0, 2, 0)}) {
        const auto x = uint32_t(0.5f * kWidth + pixels * place.x), y = uint32_t(0.5f * kHeight - pixels * place.y);
        const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
        double depth = 0;
        for (const reference::Blob& blob : blobs) depth += depthOn(blob, ray, wholeRay(ray));
        // Two axes of a spacing of 0.5, tau T at most 1 / e.
        EXPECT_NEAR(picture.at(x, y).a, std::exp(-depth), 2 * 0.25 / 11 / std::exp(1.0)) << place.x << ' ' << place.y;
    }
}

TEST_F(GridTest, WhatWouldNotFitIsRefusedInOneLine) {
    RenderSettings settings;
    MediumExtent extent;
    extent.lo = glm::vec3(-5), extent.hi = glm::vec3(5);
    for (const float deviation : {1.0f, 0.1f}) {
        extent.deviation = deviation;
        EXPECT_EQ(gridRefusal(extent, settings), "") << deviation;
    }
    extent.deviation = 0.02f; // 1000^3 nodes
    const std::string why = gridRefusal(extent, settings);
    EXPECT_NE(why.find("MiB"), why.npos) << why;
    EXPECT_EQ(why.find('\n'), why.npos);
    extent.hi = glm::vec3(9e4f), extent.deviation = 1e-6f; // nothing overflows
    EXPECT_NE(gridRefusal(extent, settings), "");
    extent = {};
    EXPECT_EQ(gridRefusal(extent, settings), ""); // nothing there
    extent.hi = glm::vec3(10), extent.deviation = 0.08f;
    EXPECT_EQ(gridRefusal(extent, settings), "");
    extent.one_albedo = false; // four kinds of nodes
    EXPECT_NE(gridRefusal(extent, settings), "");
}

// Where it is asked for all the same, the renderer makes the grid as fine as it may: a picture, if a coarse one.
TEST_F(GridTest, ARefusedGridIsCoarse) {
    std::vector<Point> points = randomPoints(100, 40, 0.02f, 2, 6);
    points.push_back({glm::vec3(0), 0.02f, 2});
    Scene scene = sceneOf(points, 1.6f);
    scene.render.method = "grid";
    const Picture picture = plain().see(scene, lookAt({0, 0, 2}, {0, 0, 0}, 0.5f), kWidth, kHeight);
    for (const glm::vec4& pixel : picture.pixels)
        for (int c = 0; c < 4; ++c) ASSERT_TRUE(std::isfinite(pixel[c]));
}

} // namespace
} // namespace brume::test::grid_test

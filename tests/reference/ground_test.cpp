// A ground with structure: a pixel sees the mean over its footprint.
#include <cmath>

#include <gtest/gtest.h>

#include "common/camera.h"
#include "tools/reference/medium_reference.h"
#include "tools/reference/pixel.h"

namespace {

using namespace brume::reference;

// Under a grey sky, a radiance of 0.5 is the mean.
World ground() {
    World world;
    world.sky_zenith = world.sky_horizon = glm::dvec3(1);
    Obstacle plane;
    plane.structure = 1;
    plane.structure_size = 2;
    world.obstacles = {plane};
    return world;
}

// The mean of a picture without filter around a pixel's centre, by a Gaussian of half a pixel.
double meanAround(const World& world, const Camera& camera, double x, double y) {
    double sum = 0, weights = 0;
    for (int i = -20; i <= 20; ++i)
        for (int j = -20; j <= 20; ++j) {
            const double s = i * 0.25, t = j * 0.25, weight = std::exp(-(s * s + t * t) / 2);
            Ray ray = rayThrough(camera, x + 0.5 * s, y + 0.5 * t);
            ray.right = ray.down = glm::dvec3(0);
            sum += weight * along(world, ray).total().x;
            weights += weight;
        }
    return sum / weights;
}

void expectMeans(const Camera& camera, double tolerance) {
    const World world = ground();
    double filtered_away = 0;
    for (const glm::dvec2 pixel : {glm::dvec2(3.5, 25.5), {20.5, 28.5}, {44.5, 26.5}, {30.5, 35.5}, {10.5, 31.5}}) {
        const double got = along(world, rayThrough(camera, pixel.x, pixel.y)).total().x;
        EXPECT_NEAR(got, meanAround(world, camera, pixel.x, pixel.y), tolerance) << pixel.x << ' ' << pixel.y;
        Ray point = rayThrough(camera, pixel.x, pixel.y);
        point.right = point.down = glm::dvec3(0);
        filtered_away = std::max(filtered_away, std::abs(along(world, point).total().x - got));
    }
    EXPECT_GT(filtered_away, 10 * tolerance);
}

TEST(Ground, ParallelRaysSeeTheMean) {
    expectMeans(orthographic(brume::lookAt({3, 4, 9}, {3.2f, 0, 0}, 1), 48, 36, 1.5), 1e-5);
}

// Within the change of the footprint across a pixel.
TEST(Ground, APerspectiveViewSeesTheMean) {
    expectMeans(perspective(brume::lookAt({3, 4, 9}, {3.2f, 0, 0}, 0.2f), 48, 36), 2e-3);
}

// A structure is no edge, though it varies within pixels. A sphere on it has one, and its pixels keep the structure.
TEST(Ground, AStructureIsNoEdge) {
    World world = ground();
    Obstacle ball;
    ball.kind = Obstacle::Kind::sphere;
    ball.centre = {3.2, 0.5, 0};
    ball.half_size = glm::dvec3(0.5);
    world.obstacles.push_back(ball);
    const Camera camera = perspective(brume::lookAt({3, 4, 9}, {3.2f, 0, 0}, 0.4f), 48, 36);
    int edges = 0, varied = 0;
    for (int y = 0; y < 36; ++y)
        for (int x = 0; x < 48; ++x) {
            const auto at = [&](double dx, double dy, bool even) {
                Ray ray = rayThrough(camera, x + dx, y + dy);
                ray.even = even;
                return along(world, ray);
            };
            const PixelResult pixel = pixelOf(at, true, hasStructure(world));
            edges += pixel.edge;
            varied += pixelOf(at, true, false).edge;
            if (!pixel.edge) {
                EXPECT_EQ(pixel.total, at(0.5, 0.5, false).total());
            }
        }
    EXPECT_GT(edges, 20) << "of the ball";
    EXPECT_LT(edges, 48 * 36 / 10);
    EXPECT_GT(varied, 2 * edges) << "the structure is too weak for this test";
}

} // namespace

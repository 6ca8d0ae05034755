// Triangles in the reference: a box made of twelve is the box.
#include <gtest/gtest.h>

#include "common/random.h"
#include "tools/reference/ray_tracer.h"

namespace brume::reference {
namespace {

constexpr glm::vec3 kCentre{1, 2, -0.5f}, kHalf{1.5f, 0.75f, 2};

std::vector<Triangle> boxOfTriangles() {
    std::vector<Triangle> triangles;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            glm::vec3 across(0), up(0), middle = kCentre;
            across[(axis + 1) % 3] = kHalf[(axis + 1) % 3];
            up[(axis + 2) % 3] = kHalf[(axis + 2) % 3];
            middle[axis] += side * kHalf[axis];
            triangles.push_back({{middle - across - up, middle + across - up, middle + across + up}, glm::vec3(0.5f)});
            triangles.push_back({{middle + across + up, middle - across - up, middle - across + up}, glm::vec3(0.5f)});
        }
    return triangles;
}

World foggy() {
    World world;
    world.fogs = {{.sigma_t = 0.1, .albedo = glm::dvec3(0.9), .lo = -10, .hi = 10}};
    world.obstacles = {{Obstacle::Kind::plane, {0, -1, 0}, glm::dvec3(0), 0, glm::dvec3(0.3)}};
    world.sky_horizon = glm::dvec3(0.1), world.sky_zenith = glm::dvec3(0.2);
    LightSource sun, lamp;
    sun.to_light = glm::normalize(glm::dvec3(0.4, 0.8, 0.3));
    lamp.kind = LightSource::Kind::point;
    lamp.position = {-2, 5, 3};
    lamp.colour = glm::dvec3(20);
    world.lights = {sun, lamp};
    return world;
}

TEST(Mesh, ABoxOfTwelveTrianglesIsTheBox) {
    World box = foggy(), mesh = foggy();
    box.obstacles.push_back({Obstacle::Kind::box, kCentre, kHalf, 0, glm::dvec3(0.5)});
    for (const Obstacle& triangle : obstaclesOf(boxOfTriangles())) mesh.obstacles.push_back(triangle);
    ASSERT_EQ(mesh.obstacles.size(), 13u);
    const Settings settings{.tolerance = 1e-9};
    const Stage box_stage(box, settings), mesh_stage(mesh, settings);
    RayTracer of_box(box_stage), of_mesh(mesh_stage);
    Random random(3);
    int hits = 0;
    for (int i = 0; i < 800; ++i) {
        const glm::dvec3 eye = glm::dvec3(kCentre) + 9.0 * glm::dvec3(random.direction());
        if (eye.y < -0.9) continue;
        const glm::dvec3 target = glm::dvec3(kCentre + 3.0f * random.inBox());
        const Ray ray{eye, glm::normalize(target - eye)};
        const Hit there = box_stage.lighting.obstacles().nearest(ray),
                  here = mesh_stage.lighting.obstacles().nearest(ray);
        hits += there.object == 1;
        ASSERT_EQ(here.object >= 1, there.object == 1);
        if (there.object >= 0) {
            ASSERT_NEAR(here.t, there.t, 1e-12 * 20);
            ASSERT_LT(glm::distance(here.normal, there.normal), 1e-12);
        }
        const RayResult truth = of_box.trace(ray), got = of_mesh.trace(ray);
        ASSERT_NEAR(got.scattered.x, truth.scattered.x, 3e-9 * truth.scattered.x) << i;
        ASSERT_NEAR(got.background.x, truth.background.x, 1e-9 * truth.background.x) << i;
    }
    EXPECT_GT(hits, 100);
}

// An edge between two triangles of one face ends no shadow; one of the twelve around the box may.
TEST(Mesh, DiagonalsAreNoEdgesOfShadows) {
    World mesh = foggy();
    mesh.obstacles = obstaclesOf(boxOfTriangles());
    const ObstacleTree tree(mesh.obstacles);
    const Ray ray{{-9, 1.3, 0.2}, glm::normalize(glm::dvec3(1, 0.03, 0.04))};
    for (const LightSource& light : mesh.lights) {
        std::vector<double> edges;
        tree.shadowEdges(light, ray, edges);
        EXPECT_EQ(edges.size(), 12u); // six silhouette edges, each of two triangles
    }
}

// A lone triangle hides light from both sides, and where it is not, nothing.
TEST(Mesh, ATriangleIsOpaqueFromBothSides) {
    const std::vector<Triangle> triangles{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, glm::vec3(0.5f)}};
    const std::vector<Obstacle> obstacles = obstaclesOf(triangles);
    for (const double side : {1.0, -1.0}) {
        const Ray through{{0.3, 0.3, side}, {0, 0, -side}}, beside{{0.6, 0.6, side}, {0, 0, -side}};
        const Hit hit = nearest(obstacles, through);
        EXPECT_EQ(hit.object, 0);
        EXPECT_DOUBLE_EQ(hit.t, 1);
        EXPECT_EQ(hit.normal, glm::dvec3(0, 0, side));
        EXPECT_TRUE(occluded(obstacles, through));
        EXPECT_FALSE(occluded(obstacles, beside));
        EXPECT_FALSE(occluded(obstacles, {through.origin, through.direction, 0, 0.9}));
        EXPECT_FALSE(occluded(obstacles, {{0.3, 0.3, 0}, {0, 0, side}})); // it begins there
    }
}

} // namespace
} // namespace brume::reference

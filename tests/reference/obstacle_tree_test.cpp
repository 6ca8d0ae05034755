// Obstacles in a tree: the same hits, shadows and edges as of asking each obstacle.
#include <algorithm>

#include <gtest/gtest.h>

#include "common/random.h"
#include "tools/reference/obstacle_tree.h"

namespace brume::reference {
namespace {

std::vector<Obstacle> someObstacles(int count) {
    Random random(5);
    std::vector<Obstacle> all;
    for (int i = 0; i < count; ++i) {
        const auto kind = i == 3 ? Obstacle::Kind::plane : i % 2 ? Obstacle::Kind::box : Obstacle::Kind::sphere;
        all.push_back({kind, 10.0f * random.inBox(), glm::abs(random.inBox()) + 0.05f, double(random.uniform(0, 3)),
                       glm::dvec3(0.5)});
    }
    all[3].centre.y = -9;
    return all;
}

std::vector<Ray> someRays() {
    Random random(6);
    std::vector<Ray> rays;
    for (int i = 0; i < 400; ++i)
        rays.push_back({15.0f * random.inBox(), glm::normalize(glm::dvec3(random.direction())), 0,
                        i % 4 == 0 ? kInfinity : double(random.uniform(1, 40))});
    rays.push_back({{0, 20, 0}, {0, -1, 0}}); // along an axis
    return rays;
}

TEST(ObstacleTree, HitsWhatIsHitAndHidesWhatIsHidden) {
    const std::vector<Obstacle> all = someObstacles(150);
    const ObstacleTree tree(all);
    int hits = 0;
    for (const Ray& ray : someRays()) {
        const Hit flat = nearest(all, ray), found = tree.nearest(ray);
        ASSERT_EQ(found.object, flat.object);
        ASSERT_EQ(found.t, flat.t);
        ASSERT_EQ(found.normal, flat.normal);
        hits += flat.object >= 0;
        for (const int skip : {-1, flat.object}) ASSERT_EQ(tree.occluded(ray, skip), occluded(all, ray, skip));
    }
    EXPECT_GT(hits, 100);
}

// Edges of shadows that do not reach the ray may be left out: where light comes and goes is the same.
TEST(ObstacleTree, KeepsEveryEdgeOfAShadowOnTheRay) {
    const std::vector<Obstacle> all = someObstacles(60);
    const ObstacleTree tree(all);
    LightSource sun, lamp;
    sun.to_light = glm::normalize(glm::dvec3(0.4, 0.8, 0.3));
    lamp.kind = LightSource::Kind::point;
    lamp.position = {1, 4, 2};
    size_t kept = 0, asked = 0, changes = 0;
    for (const LightSource& light : {sun, lamp})
        for (Ray ray : someRays()) {
            ray.origin -= 40.0 * ray.direction; // outside all of them
            ray.end = 80;
            ray.end = std::min(ray.end, nearest(all, ray).t - 1e-6);
            std::vector<double> edges, flat;
            tree.shadowEdges(light, ray, edges);
            for (const Obstacle& o : all) shadowEdges(o, light, ray, flat);
            kept += edges.size(), asked += flat.size();
            bool before = false;
            for (int i = 0; i <= 600; ++i) {
                const double t = ray.begin + (ray.end - ray.begin) * i / 600;
                const glm::dvec3 x = ray.at(t), to = light.position - x;
                const bool distant = light.kind == LightSource::Kind::directional;
                const Ray toward{x, distant ? light.to_light : glm::normalize(to), 0,
                                 distant ? kInfinity : glm::length(to)};
                const bool hidden = occluded(all, toward);
                const bool changed = i > 0 && hidden != before;
                before = hidden;
                if (changed) {
                    ++changes;
                    const double step = (ray.end - ray.begin) / 600;
                    ASSERT_TRUE(std::ranges::any_of(edges, [&](double e) { return e >= t - step && e <= t; })) << t;
                }
            }
        }
    EXPECT_GT(changes, 300u);
    EXPECT_LT(kept, asked / 2);
}

} // namespace
} // namespace brume::reference

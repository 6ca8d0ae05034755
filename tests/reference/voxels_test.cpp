// The exact way of a ray through a volume.
#include "tools/reference/voxels.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tools/reference/medium_reference.h"

namespace brume::reference::voxels_test {
namespace {

VoxelMedium mediumOf(glm::uvec3 size, double spacing, const std::function<double(glm::dvec3)>& extinction) {
    auto volume = std::make_shared<Volume>();
    volume->size = size, volume->spacing = spacing;
    for (uint32_t z = 0; z < size.z; ++z)
        for (uint32_t y = 0; y < size.y; ++y)
            for (uint32_t x = 0; x < size.x; ++x) volume->extinction.push_back(float(extinction({x, y, z})));
    return {volume, {-1, 2, 3}, 1.5, glm::dvec3(0.5)};
}

// Trilinear in double, voxel by voxel.
double extinctionAt(const VoxelMedium& medium, glm::dvec3 x) {
    const glm::dvec3 at = (x - medium.origin) / medium.volume->spacing, cell = glm::floor(at), t = at - cell;
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 corner(i & 1, i >> 1 & 1, i >> 2);
        const double part = (i & 1 ? t.x : 1 - t.x) * (i & 2 ? t.y : 1 - t.y) * (i & 4 ? t.z : 1 - t.z);
        sum += part * double(medium.volume->at(glm::ivec3(cell) + corner));
    }
    return medium.times * sum;
}

TEST(Voxels, DepthsAndPartsAreTheTrilinearSum) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    const VoxelMedium medium =
        mediumOf({5, 4, 6}, 0.5, [&](glm::dvec3) { return unit(random) < 0.4 ? 0 : unit(random); });
    const VoxelPath path(medium);
    int crossed = 0;
    for (int i = 0; i < 200; ++i) {
        const glm::dvec3 from = medium.origin + 6.0 * glm::dvec3(unit(random), unit(random), unit(random)) - 2.0;
        const glm::dvec3 to = medium.origin + 0.5 * glm::dvec3(4 * unit(random), 3 * unit(random), 5 * unit(random));
        const Ray ray{from, glm::normalize(to - from), 0, 3 + 4 * unit(random)};
        const int steps = 20000;
        double sum = 0;
        for (int s = 0; s < steps; ++s)
            sum += extinctionAt(medium, ray.at((s + 0.5) / steps * ray.end)) * ray.end / steps;
        EXPECT_NEAR(path.depth(ray), sum, 1e-6);
        std::vector<CellPart> parts;
        path.along(ray, parts);
        double by_parts = 0;
        for (const CellPart& part : parts) {
            const double t = part.begin + unit(random) * (part.end - part.begin);
            EXPECT_NEAR(part.extinctionAt(t), extinctionAt(medium, ray.at(t)), 1e-9);
            by_parts += part.depthTo(part.end);
            EXPECT_NEAR(part.depthTo(part.begin), 0, 1e-12);
            ++crossed;
        }
        EXPECT_NEAR(by_parts, path.depth(ray), 1e-9);
    }
    EXPECT_GT(crossed, 500);
}

// Along an axis through one voxel's middle the sum is a tent.
TEST(Voxels, OneVoxelIsATent) {
    const VoxelMedium medium = mediumOf({1, 1, 1}, 0.5, [](glm::dvec3) { return 2; });
    const VoxelPath path(medium);
    EXPECT_NEAR(path.depth({{-9, 2, 3}, {1, 0, 0}}), 1.5 * 2 * 0.5, 1e-12);
    EXPECT_NEAR(path.depth({{-9, 2.25, 3}, {1, 0, 0}}), 0.5 * 1.5 * 2 * 0.5, 1e-12);
    EXPECT_EQ(path.depth({{-9, 2.5, 3}, {1, 0, 0}}), 0);
    EXPECT_NEAR(path.depth({{-1, 2, 3}, {1, 0, 0}}), 0.5 * 1.5 * 2 * 0.5, 1e-12);
}

// Light of an even sky in a medium of albedo 1 is that of the sky, whatever the medium.
TEST(Voxels, AnEvenSkyIsSeenThroughThem) {
    World world;
    world.voxels = mediumOf({4, 4, 4}, 0.5, [](glm::dvec3 x) { return 0.2 + 0.3 * x.x; });
    world.voxels.albedo = glm::dvec3(1);
    world.ambient = world.sky_horizon = world.sky_zenith = glm::dvec3(1);
    const RayResult seen = along(world, {{-6, 2.3, 3.6}, glm::normalize(glm::dvec3(5, 0.3, 0.2))}, {.tolerance = 1e-9});
    EXPECT_LT(seen.transmittance, 0.5);
    EXPECT_NEAR(seen.total().x, 1, 1e-8);
}

} // namespace
} // namespace brume::reference::voxels_test

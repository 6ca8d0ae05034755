// Shadow frusta against rays in double.
#include "tests/gpu/shadow_voxels.h"

namespace brume::test::shadow_frustum_test {
namespace {

// Froxels of eyes with pictures of different sizes, none a multiple of a froxel.
TEST_F(GpuTest, ShadowFrustaHaveWhatRaysFind) {
    const Scene scene = crowdedScene(true);
    Gridded gridded(device(), scene, glm::vec3(-4), glm::vec3(4));
    ShadowFrusta frusta(device());
    const ShadowSlices slices{.count = 20, .near = 0.05f, .unit = 0.8f, .growth = 0.2f};
    const std::vector<gpu::Eye> eyes{eyeBlock({lookAt({0, 0, 6}, {0.5f, 0, 0}, 0.9f), 150, 90}, scene.render),
                                     eyeBlock({lookAt({-5, 2, 0}, {0, 0, 1}, 1.2f), 321, 201}, scene.render)};
    const reference::World world = reference::worldOf(scene, {});
    const reference::ObstacleTree tree(world.obstacles);
    uint64_t compared = 0, lit = 0, wrong = 0, froxels = 0;
    for (uint32_t view = 0; view < 2; ++view) {
        const std::vector<uint32_t> bits = gridded.frustum(frusta, eyes, slices, view);
        const gpu::ShadowGridBlock& shape = gridded.grid().shape();
        ASSERT_EQ(shape.slots, 4u);
        const gpu::Eye& eye = eyes[view];
        const uint32_t columns = gpu::groups(eye.size.x, 16), rows = gpu::groups(eye.size.y, 16);
        ASSERT_EQ(bits.size(), size_t(columns) * rows * slices.count);
        froxels += bits.size();
        for (uint32_t i = 0; i < bits.size(); ++i) {
            const uint32_t slice = i / (columns * rows);
            const double depth = double(slices.near) +
                                 double(slices.unit) * (std::exp2(double(slices.growth) * (double(slice) + 0.5)) - 1);
            const glm::dvec2 pixel = 16.0 * (glm::dvec2(i % columns, i / columns % rows) + 0.5);
            const glm::dvec3 x =
                glm::dvec3(eye.position) + depth * (glm::dvec3(eye.ray) + pixel.x * glm::dvec3(eye.ray_right) +
                                                    pixel.y * glm::dvec3(eye.ray_down));
            const bool inside = isInSolid(world, x);
            for (uint32_t s = 0; s < shape.slots; ++s) {
                const glm::dvec3 to(shape.lights[s].to), toward = shape.lights[s].local != 0 ? to - x : to;
                const double end = shape.lights[s].local != 0 ? glm::length(toward) : reference::kInfinity;
                const bool truth = !inside && !tree.occluded({x, glm::normalize(toward), 0, end});
                ++compared, lit += truth;
                wrong += truth != ((bits[i] >> s & 1) != 0);
            }
        }
    }
    EXPECT_EQ(frusta.count(), froxels);
    EXPECT_LE(double(wrong), 2e-3 * double(compared)) << wrong << " of " << compared;
    EXPECT_GT(double(lit), 0.1 * double(compared));
    EXPECT_LT(double(lit), 0.9 * double(compared));
}

} // namespace
} // namespace brume::test::shadow_frustum_test

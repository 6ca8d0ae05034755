// The volumetric shadow map's resolution: laws of scale, of rounding, and what must not matter.
#include <cmath>

#include "server/medium/shadow_resolution.h"
#include "tests/gpu/fixture.h"

namespace brume::test::shadow_resolution_test {
namespace {

constexpr glm::mat3 kAxes(1);

std::vector<gpu::Particle> cloud(int count, float scale, float sigma_t, glm::vec3 half, uint32_t seed = 1) {
    Random random(seed);
    std::vector<gpu::Particle> particles;
    for (int i = 0; i < count; ++i) particles.push_back({random.inCube(1) * half, scale, glm::vec3(1), sigma_t});
    return particles;
}

ShadowResolution follow(const std::vector<gpu::Particle>& particles, glm::vec3 extent,
                        const RenderSettings& settings = {}) {
    return shadowResolution(settings, ShadowedMedium(particles, 1, kAxes), extent);
}

TEST(ShadowResolutionTest, KeepsWhatIsAskedFor) {
    RenderSettings settings;
    settings.shadow_size = 37;
    settings.shadow_slices = 5;
    const auto particles = cloud(500, 9, 0.05f, glm::vec3(5));
    const ShadowResolution fixed = follow(particles, glm::vec3(18), settings);
    EXPECT_EQ(fixed.texels, glm::uvec2(37));
    EXPECT_EQ(fixed.slices, 5u);
    settings.shadow_slices = 0;
    EXPECT_EQ(follow(particles, glm::vec3(18), settings).texels, glm::uvec2(37));
    EXPECT_EQ(follow(particles, glm::vec3(18), settings).slices, follow(particles, glm::vec3(18)).slices);
}

// A scene ten times as large in every length, as thick, has the same map: only ratios of lengths and depths count.
TEST(ShadowResolutionTest, DoesNotDependOnTheUnitOfLength) {
    const auto small = cloud(500, 9, 0.05f, glm::vec3(5, 7, 6)), large = cloud(500, 90, 0.005f, glm::vec3(50, 70, 60));
    const ShadowResolution a = follow(small, {18, 22, 20}), b = follow(large, {180, 220, 200});
    EXPECT_EQ(a.texels, b.texels);
    EXPECT_EQ(a.slices, b.slices);
    EXPECT_NEAR(a.error, b.error, 1e-4 * a.error);
}

TEST(ShadowResolutionTest, ASmallerErrorCostsMoreAndIsKept) {
    const auto particles = cloud(5000, 6, 0.02f, glm::vec3(5));
    double last_cells = 0, last_error = 1;
    for (const float wanted : {2e-3f, 1e-3f, 5e-4f, 2e-4f}) {
        RenderSettings settings;
        settings.shadow_error = wanted;
        const ShadowResolution r = follow(particles, {16, 18, 17}, settings);
        const double cells = double(r.texels.x) * r.texels.y * r.slices;
        EXPECT_LE(r.error, double(wanted));
        EXPECT_GT(cells, last_cells) << wanted;
        EXPECT_LT(r.error, last_error) << wanted;
        last_cells = cells;
        last_error = r.error;
    }
}

// Finer particles, finer texels; and as many as a side is long.
TEST(ShadowResolutionTest, FollowsDeviationsAndExtents) {
    const auto coarse = cloud(20000, 4, 0.02f, glm::vec3(5)), fine = cloud(20000, 2, 0.04f, glm::vec3(5));
    EXPECT_GT(follow(fine, glm::vec3(14)).texels.x, 1.3 * follow(coarse, glm::vec3(14)).texels.x);
    EXPECT_GT(follow(fine, glm::vec3(14)).slices, follow(coarse, glm::vec3(14)).slices);
    const ShadowResolution tall = follow(cloud(20000, 2, 0.04f, {2, 8, 2}), {6, 18, 6});
    EXPECT_GT(tall.texels.y, 2 * tall.texels.x);
}

// What a few thin and small particles add to the light's depth is nothing to speak of: they must not force a huge map.
TEST(ShadowResolutionTest, AFewThinSmallParticlesDoNotMatter) {
    auto particles = cloud(500, 9, 0.05f, glm::vec3(5));
    const ShadowResolution without = follow(particles, glm::vec3(18));
    const auto thin = cloud(50, 0.1f, 0.05f, glm::vec3(5), 2); // a hundredth of the others' depth each
    particles.insert(particles.end(), thin.begin(), thin.end());
    const ShadowResolution with = follow(particles, glm::vec3(18));
    EXPECT_EQ(with.texels, without.texels);
    EXPECT_EQ(with.slices, without.slices);
}

// Sizes are whole tiles and layers, and few: a medium that moves does not make a new image every tick.
TEST(ShadowResolutionTest, SizesAreOfACoarseLadder) {
    const auto particles = cloud(5000, 3, 0.04f, glm::vec3(5));
    int changes = 0;
    ShadowResolution last = follow(particles, glm::vec3(12));
    for (float extent = 12; extent < 24; extent *= 1.01f) {
        const ShadowResolution r = follow(particles, glm::vec3(extent));
        EXPECT_EQ(r.texels.x % 8, 0u);
        EXPECT_EQ(r.slices % 6, 1u);
        EXPECT_GE(r.texels.x, last.texels.x);
        changes += r.texels != last.texels;
        last = r;
    }
    EXPECT_LE(changes, 5); // an octave
    EXPECT_GE(changes, 3);
}

TEST(ShadowResolutionTest, IsBounded) {
    const ShadowResolution nothing = follow({}, glm::vec3(2));
    EXPECT_EQ(nothing.texels, glm::uvec2(32));
    EXPECT_EQ(nothing.slices, 19u);
    EXPECT_EQ(nothing.error, 0);
    const ShadowResolution one = follow({{{0, 0, 0}, 1, glm::vec3(1), 3}}, glm::vec3(0.8f));
    EXPECT_GE(one.texels.x, 32u);
    EXPECT_LE(one.texels.x, 48u); // a few standard deviations are all there is
    RenderSettings settings;
    settings.shadow_error = 1e-4f;
    const auto dust = cloud(3000, 0.05f, 300, glm::vec3(50));
    const ShadowResolution most = follow(dust, glm::vec3(100), settings);
    EXPECT_LE(double(most.texels.x) * most.texels.y * most.slices, double(1 << 25));
    EXPECT_LE(most.slices, 193u);
    EXPECT_GT(most.error, 1e-4); // and says so
}

// A million particles are judged by some of them.
TEST(ShadowResolutionTest, SamplesStandForAll) {
    const auto some = cloud(4096, 2, 0.04f, glm::vec3(5)), many = cloud(100000, 2, 0.04f * 4096 / 100000, glm::vec3(5));
    const ShadowedMedium a(some, 1, kAxes), b(many, 1, kAxes);
    // As thick, but 24 times as many: the body's part stays, the random part shrinks by the square root, which the
    // samples show to a hundredth or two.
    const double fewer = std::sqrt(4096.0 / 100000);
    EXPECT_LT(b.planeError(0.1), a.planeError(0.1));
    EXPECT_GT(b.planeError(0.1), 0.95 * fewer * a.planeError(0.1));
    EXPECT_LT(b.texelError(0.1), 1.5 * fewer * a.texelError(0.1));
    EXPECT_GT(b.texelError(0.1), 0.95 * fewer * a.texelError(0.1));
}

} // namespace
} // namespace brume::test::shadow_resolution_test

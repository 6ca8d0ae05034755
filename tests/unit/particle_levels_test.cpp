// Ordering and merging particles without a device: what is kept, what stays, and that nothing but the particles
// matters.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/random.h"
#include "common/scene.h"
#include "common/tetrahedra.h"
#include "server/medium/levels.h"
#include "server/plan/memory.h"

namespace brume {
namespace {

constexpr float kFalloff = 1.6f;

std::vector<gpu::Particle> randomParticles(uint32_t count, float side, Range scale, Range sigma_t, uint64_t seed = 1) {
    Random random(seed);
    std::vector<gpu::Particle> all(count);
    for (gpu::Particle& p : all) {
        p.centre = random.inBox() * (0.5f * side);
        p.scale = random.uniform(scale.lo, scale.hi);
        p.sigma_t = random.uniform(sigma_t.lo, sigma_t.hi);
        p.albedo = {random.uniform(), random.uniform(), random.uniform()};
    }
    return all;
}

std::vector<gpu::Particle> ordered(std::span<const gpu::Particle> particles) {
    std::vector<gpu::Particle> out(particles.size());
    SpatialOrder().sort(particles, out);
    return out;
}

std::vector<gpu::Particle> mergedAt(std::span<const gpu::Particle> particles, int exponent) {
    std::vector<gpu::Particle> out;
    mergeCells(ordered(particles), kFalloff, exponent, out);
    return out;
}

// In the order of their bits: what is compared is the representation, not the value.
int compareBits(const gpu::Particle& a, const gpu::Particle& b) {
    return std::memcmp(&a, &b, sizeof a); // NOLINT(bugprone-suspicious-memory-comparison)
}
bool sameBits(const gpu::Particle& a, const gpu::Particle& b) { return compareBits(a, b) == 0; }
bool sameBits(std::span<const gpu::Particle> a, std::span<const gpu::Particle> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

double deviationOf(const gpu::Particle& p) { return 0.1 * double(p.scale) * double(kFalloff); }
double depthOf(const gpu::Particle& p) { return std::sqrt(2 * std::numbers::pi) * double(p.sigma_t) * deviationOf(p); }

struct Moments {
    double mass = 0, second = 0; // of the extinction over space: integral, and of |x|^2
    glm::dvec3 first{0}, scattered{0};
};

Moments momentsOf(std::span<const gpu::Particle> particles) {
    Moments all;
    for (const gpu::Particle& p : particles) {
        const double s = deviationOf(p), m = std::pow(2 * std::numbers::pi, 1.5) * double(p.sigma_t) * s * s * s;
        const glm::dvec3 x(p.centre);
        all.mass += m;
        all.first += m * x;
        all.second += m * (3 * s * s + glm::dot(x, x));
        all.scattered += m * glm::dvec3(p.albedo);
    }
    return all;
}

// Of numbers of size 1 to 10 in float32: half a unit of 6e-8 for each factor of sigma_t s^3 and of |x|^2, which are not
// all of one sign.
constexpr double kRounding = 2e-7;

TEST(MergedParticles, KeepTheMomentsOfWhatTheyStandFor) {
    for (const int exponent : {-2, 0, 1}) {
        const auto all = randomParticles(30'000, 8, {0.2f, 2}, {0.001f, 0.02f});
        const auto merged = mergedAt(all, exponent);
        EXPECT_LT(merged.size(), all.size() * 9 / 10) << exponent;
        const Moments was = momentsOf(all), is = momentsOf(merged);
        EXPECT_NEAR(is.mass / was.mass, 1, kRounding);
        EXPECT_NEAR(is.second / was.second, 1, kRounding);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(is.first[axis] / was.mass, was.first[axis] / was.mass, kRounding);
            EXPECT_NEAR(is.scattered[axis] / was.scattered[axis], 1, kRounding);
        }
    }
}

TEST(MergedParticles, FarFromZeroKeepThemToo) { // 40 km: places there are 4 mm apart
    auto all = randomParticles(2000, 64, {2, 4}, {1e-4f, 1e-4f});
    for (gpu::Particle& p : all) p.centre += glm::vec3(40'000, 0, -40'000);
    const auto merged = mergedAt(all, 5);
    ASSERT_LT(merged.size(), 200u);
    auto back = merged;
    for (auto* list : {&all, &back})
        for (gpu::Particle& p : *list) p.centre -= glm::vec3(40'000, 0, -40'000);
    const Moments was = momentsOf(all), is = momentsOf(back);
    EXPECT_NEAR(is.mass / was.mass, 1, kRounding);
    EXPECT_LT(glm::distance(is.first, was.first) / was.mass,
              2e-3 / std::sqrt(double(merged.size()))); // half a place each
    EXPECT_NEAR(is.second / was.second, 1, 1e-4);       // the same, of 64 m
}

TEST(MergedParticles, AreAFunctionOfTheParticlesAlone) {
    const auto all = randomParticles(20'000, 8, {0.2f, 1}, {0.01f, 0.05f});
    SpatialOrder used; // has seen others before
    std::vector<gpu::Particle> order(30'000), merged, again;
    used.sort(randomParticles(30'000, 3, {1, 1}, {1, 1}, 7), order);
    order.resize(all.size());
    used.sort(all, order);
    EXPECT_TRUE(sameBits(order, ordered(all)));
    mergeCells(order, kFalloff, -1, merged);
    EXPECT_TRUE(sameBits(merged, mergedAt(all, -1)));
}

// The bits follow from the order in which the simulation has its particles; what they are as a medium does not.
TEST(MergedParticles, AreTheSameMediumInAnyOrder) {
    auto all = randomParticles(20'000, 8, {0.2f, 1}, {1e-5f, 2e-5f}); // so thin that no cell is divided
    const auto merged = mergedAt(all, 0);
    std::reverse(all.begin(), all.end());
    const auto other = mergedAt(all, 0);
    ASSERT_EQ(merged.size(), other.size());
    const Moments a = momentsOf(merged), b = momentsOf(other);
    EXPECT_NEAR(a.mass / b.mass, 1, kRounding);
    EXPECT_NEAR(a.second / b.second, 1, kRounding);
}

TEST(MergedParticles, ThickOnesStayAsTheyAre) {
    const gpu::Particle thin{{0.5f, 0.5f, 0.5f}, 0.5f, glm::vec3(1), 0.01f};
    gpu::Particle thick = thin;
    thick.sigma_t *= float(1.001 * kMostMergedDepth / depthOf(thin));
    std::vector<gpu::Particle> out;
    mergeCells(std::vector(10, thick), kFalloff, 0, out);
    ASSERT_EQ(out.size(), 10u);
    for (const gpu::Particle& p : out) EXPECT_TRUE(sameBits(p, thick));
    // Together they may be as thick as one may be alone.
    gpu::Particle third = thin;
    third.sigma_t *= float(0.333 * kMostMergedDepth / depthOf(thin));
    out.clear();
    mergeCells(std::vector(30, third), kFalloff, 0, out);
    EXPECT_EQ(out.size(), 10u);
    for (const gpu::Particle& p : out) EXPECT_NEAR(depthOf(p), 0.999 * kMostMergedDepth, 1e-6);
}

TEST(MergedParticles, AreNeverThickerThanTheBound) {
    const auto all = randomParticles(30'000, 8, {0.1f, 2}, {0.001f, 1});
    const auto stay = [](const gpu::Particle& p) { return depthOf(p) > 1.000001 * kMostMergedDepth; };
    const auto merged = mergedAt(all, 0);
    EXPECT_EQ(std::count_if(merged.begin(), merged.end(), stay), std::count_if(all.begin(), all.end(), stay));
}

TEST(MergedParticles, OnlyOnesOfASizeAndOfACell) {
    const gpu::Particle one{{0.25f, 0.25f, 0.25f}, 1, {0.5f, 0.25f, 1}, 0.01f};
    const auto left = [](std::vector<gpu::Particle> all, int exponent) {
        std::vector<gpu::Particle> out;
        mergeCells(all, kFalloff, exponent, out);
        return out;
    };
    EXPECT_EQ(left({one, one}, 0).size(), 1u);
    gpu::Particle other = one;
    other.centre.x = -0.25f; // a cell of 1 m further, all the same with cells of 4 m: they count from zero
    EXPECT_EQ(left({one, other}, 0).size(), 2u);
    EXPECT_EQ(left({one, other}, 2).size(), 2u);
    other = one;
    other.scale = 5;
    EXPECT_EQ(left({one, other}, 0).size(), 2u);
    other.scale = 30; // four cells and more
    EXPECT_TRUE(sameBits(left({other, other}, 0), std::vector{other, other}));
    other = one;
    other.sigma_t = 0; // nothing is there
    EXPECT_TRUE(sameBits(left({other, other}, 0), std::vector{other, other}));
    EXPECT_TRUE(sameBits(left({one}, 0), std::vector{one}));
    EXPECT_EQ(left({one, one}, 0)[0].albedo, one.albedo); // to the bit: methods ask whether all are the same
}

TEST(MergeLevel, FollowsTheDistanceOfTheMediumAndNothingElse) {
    MediumExtent extent;
    extent.lo = glm::vec3(-5);
    extent.hi = glm::vec3(5);
    const auto at = [&](float z, uint32_t height, float merge) {
        return mergeLevel(lookAt({0, 0, z}, {0, 0, 0}, 0.8f), height * 2, height, extent, merge);
    };
    EXPECT_EQ(at(4, 360, 1), kNoLevel);
    EXPECT_EQ(at(105, 360, 0), kNoLevel);
    EXPECT_EQ(at(205, 360, 1), at(105, 360, 1) + 1);
    EXPECT_EQ(at(105, 180, 1), at(105, 360, 1) + 1);
    EXPECT_EQ(at(105, 360, 2), at(105, 360, 1) + 1);
    // A cell is never wider than asked for: pixels are smallest where the picture's corner sees the nearest side.
    const double tan_y = std::tan(0.4), depth = 100 / std::sqrt(1 + 5 * tan_y * tan_y);
    const double cell = std::exp2(at(105, 360, 1));
    EXPECT_LE(cell, depth * 2 * tan_y / 360);
    EXPECT_GT(2 * cell, depth * 2 * tan_y / 360);
}

TEST(SpatialOrder, HasAllParticlesAndPutsNeighboursTogether) {
    const auto all = randomParticles(1 << 15, 8, {0.2f, 1}, {0.01f, 0.05f});
    auto sorted = ordered(all);
    double side = 0;
    for (size_t i = 0; i < sorted.size(); i += 32) {
        glm::vec3 lo(1e30f), hi(-1e30f);
        for (size_t j = i; j < i + 32; ++j) lo = glm::min(lo, sorted[j].centre), hi = glm::max(hi, sorted[j].centre);
        side += double(glm::length(hi - lo)) / 1024;
    }
    EXPECT_LT(side, 2.5); // of a cube of 8 m, in which 32 of them have 0.8 m of their own; as they came: about 13 m
    auto before = all;
    const auto less = [](const gpu::Particle& a, const gpu::Particle& b) { return compareBits(a, b) < 0; };
    std::sort(before.begin(), before.end(), less);
    std::sort(sorted.begin(), sorted.end(), less);
    EXPECT_TRUE(sameBits(before, sorted));
    // Those at one place keep their order.
    std::vector<gpu::Particle> same(100, all[0]);
    for (size_t i = 0; i < same.size(); ++i) same[i].scale = float(i + 1);
    EXPECT_TRUE(sameBits(ordered(same), same));
    EXPECT_TRUE(ordered({}).empty());
}

TEST(ParticleMemory, ARefusalNamesTheCountThatFits) {
    EXPECT_EQ(memoryRefusal(1'000'000, 1024ull << 20), "");
    const std::string wrong = memoryRefusal(1'000'000, 256ull << 20);
    const size_t at = wrong.find("use at most ");
    ASSERT_NE(at, wrong.npos) << wrong;
    const auto fits = uint32_t(std::stoul(wrong.substr(at + 12)));
    EXPECT_EQ(memoryRefusal(fits, 256ull << 20), "");
    EXPECT_NE(memoryRefusal(fits + 1, 256ull << 20), "");
}

TEST(ParticleMemory, ARefusalNamesTheMeshAndNeverACountOfNone) {
    Tetrahedra mesh;
    mesh.corners.resize(60'000);
    mesh.faces.resize(4'000);
    const uint64_t all = particleMemory(14'398).total() + tetrahedraMemory(&mesh).total();
    EXPECT_EQ(memoryRefusal(14'398, all, 0, &mesh), "");
    EXPECT_EQ(memoryRefusal(14'398, 5ull << 20, 0, &mesh),
              fmt::format("60000 tetrahedra with 14398 corners take {} MiB, --memory allows 5: use a smaller mesh or "
                          "allow more",
                          (all + (1 << 20) - 1) >> 20));
    const std::string kept = memoryRefusal(1000, 5ull << 20, 9ull << 20);
    EXPECT_NE(kept.find("--memory allows 5: use fewer particles or allow more"), kept.npos) << kept;
}

} // namespace
} // namespace brume

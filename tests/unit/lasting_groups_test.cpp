// Groups of a large medium: how many, that they keep what they stand for, and that they last.
#include <random>

#include <gtest/gtest.h>

#include "server/medium/group.h"
#include "server/medium/lasting_groups.h"

namespace brume {
namespace {

std::vector<gpu::Particle> particlesOf(size_t count) {
    std::mt19937 random(3);
    const auto unit = [&] { return float(random()) / 4294967296.0f; };
    std::vector<gpu::Particle> all(count);
    for (gpu::Particle& p : all) {
        p.centre = {10 * unit() - 1000, 20 * unit(), 5 * unit()};
        p.scale = 0.1f + 0.1f * unit();
        p.albedo = {unit(), 0.5f, 1};
        p.sigma_t = 2 * unit();
    }
    return all;
}

double massOf(const std::vector<gpu::Particle>& all, double falloff) {
    double mass = 0;
    for (const gpu::Particle& p : all) {
        const double s = 0.1 * double(p.scale) * falloff;
        mass += kUnitMass * double(p.sigma_t) * s * s * s;
    }
    return mass;
}

TEST(LastingGroups, AreAsManyAsAllowedAndKeepTheMass) {
    const std::vector<gpu::Particle> particles = particlesOf(50'000);
    LastingGroups groups;
    for (const uint32_t most : {1u, 100u, 5000u, 16'384u, 60'000u}) {
        groups.build(particles, most);
        EXPECT_LE(groups.size(), most);
        EXPECT_GE(groups.size(), std::min<size_t>(most / 4, 50'000 / 2)) << "cells are as small as that allows";
        std::vector<gpu::Particle> merged;
        groups.merge(particles, 1.6f, merged);
        EXPECT_EQ(merged.size(), groups.size());
        const double mass = massOf(particles, 1.6);
        EXPECT_NEAR(massOf(merged, 1.6), mass, 1e-5 * mass);
    }
}

TEST(LastingGroups, FollowTheirMembers) {
    std::vector<gpu::Particle> particles = particlesOf(20'000), before, after;
    LastingGroups groups;
    groups.build(particles, 1000);
    groups.merge(particles, 1.6f, before);
    for (gpu::Particle& p : particles) p.centre += glm::vec3(0.5f, -0.25f, 0.125f);
    groups.merge(particles, 1.6f, after);
    ASSERT_EQ(before.size(), after.size());
    for (size_t i = 0; i < before.size(); ++i) {
        EXPECT_LT(glm::distance(after[i].centre, before[i].centre + glm::vec3(0.5f, -0.25f, 0.125f)), 2e-4f);
        EXPECT_NEAR(after[i].scale, before[i].scale, 1e-3f * before[i].scale);
    }
}

TEST(LastingGroups, OfNoneAndOfOnePlace) {
    LastingGroups groups;
    groups.build({}, 10);
    EXPECT_EQ(groups.size(), 0u);
    std::vector<gpu::Particle> same(100, particlesOf(1)[0]), merged;
    groups.build(same, 10);
    EXPECT_EQ(groups.size(), 1u);
    groups.merge(same, 1.6f, merged);
    EXPECT_NEAR(merged[0].sigma_t, 100 * same[0].sigma_t, 1e-3f * merged[0].sigma_t);
}

} // namespace
} // namespace brume

// Tetrahedra of a scene's particles: a lattice without gaps, its extinction, and the file that scenes read.
#include "tools/bench/lattice.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "common/ply/ply.h"
#include "common/tetrahedra.h"

namespace brume::bench {
namespace {

// Two Gaussians, u = 2 and u = 1. The first is red.
std::vector<gpu::Particle> pair() {
    return {{{0, 0, 0}, 2, {0.9f, 0.2f, 0.1f}, 3}, {{1.5f, 0.25f, 0}, 1, {0.1f, 0.2f, 0.9f}, 5}};
}

double extinctionAt(glm::dvec3 place) {
    double sum = 0;
    for (const gpu::Particle& p : pair()) {
        const glm::dvec3 to = place - glm::dvec3(p.centre);
        sum += double(p.sigma_t) * std::exp(-50 * glm::dot(to, to) / double(p.scale * p.scale));
    }
    return sum;
}

Tetrahedra connectedOf(const Lattice& lattice) {
    return connected(lattice.corners, std::vector<glm::vec3>(lattice.position.begin(), lattice.position.end()), "l");
}

double volumeOf(const Lattice& lattice, const glm::uvec4& cell) {
    const auto& at = lattice.position;
    const glm::dvec3 a = at[cell.x], across = glm::cross(at[cell.y] - a, at[cell.z] - a);
    return glm::dot(across, at[cell.w] - a) / 6;
}

TEST(LatticeOfTetrahedra, IsClosedAndEndsWithNoExtinction) {
    const Lattice lattice = latticeOf(pair(), 1, 16);
    const Tetrahedra all = connectedOf(lattice);
    glm::dvec3 sum(0);
    double volume = 0;
    std::vector<bool> outside(lattice.position.size());
    for (const Tetrahedra::Face& face : all.faces) {
        const glm::dvec3 a = lattice.position[face.corners.x], b = lattice.position[face.corners.y],
                         c = lattice.position[face.corners.z], area = 0.5 * glm::cross(b - a, c - a);
        sum += area;
        volume += glm::dot(a, area) / 3;
        for (int m = 0; m < 3; ++m) outside[face.corners[m]] = true;
    }
    EXPECT_LT(glm::length(sum), 1e-9);
    double cells = 0;
    for (const glm::uvec4& cell : all.corners) {
        EXPECT_NEAR(volumeOf(lattice, cell), std::pow(lattice.cell, 3) / 12, 1e-6 * std::pow(lattice.cell, 3));
        cells += volumeOf(lattice, cell);
    }
    EXPECT_NEAR(volume, cells, 1e-6 * cells) << "no gaps: what the outside holds";
    EXPECT_GT(std::ranges::count(outside, false), 100);
    double most = 0;
    for (const glm::dvec3& place : lattice.position) most = std::max(most, extinctionAt(place));
    std::vector<bool> used(lattice.position.size());
    for (const glm::uvec4& cell : all.corners) {
        double thickest = 0;
        for (int m = 0; m < 4; ++m) {
            used[cell[m]] = true;
            thickest = std::max(thickest, extinctionAt(lattice.position[cell[m]]));
        }
        EXPECT_GE(thickest, 0.999e-3 * most);
    }
    EXPECT_EQ(std::ranges::count(used, false), 0);
    for (size_t i = 0; i < lattice.position.size(); ++i) {
        const double own = extinctionAt(lattice.position[i]);
        EXPECT_NEAR(double(lattice.sigma_t[i]), outside[i] ? 0 : own, 1e-6 * own + 1e-6);
        if (outside[i]) {
            EXPECT_LT(own, 1e-3 * most) << "what is cut off is thin";
        }
    }
}

TEST(LatticeOfTetrahedra, HasTheParticlesMassAndAlbedo) {
    const Lattice lattice = latticeOf(pair(), 1, 48);
    double mass = 0;
    glm::dvec3 scattered(0);
    for (const glm::uvec4& cell : lattice.corners)
        for (int m = 0; m < 4; ++m) {
            const double part = std::abs(volumeOf(lattice, cell)) * double(lattice.sigma_t[cell[m]]) / 4;
            mass += part;
            scattered += part * glm::dvec3(lattice.albedo.at(cell[m]));
        }
    double wanted = 0;
    glm::dvec3 wanted_scattered(0);
    for (const gpu::Particle& p : pair()) { // sigma (u / 10 sqrt(2 pi))^3
        const double own = double(p.sigma_t) * std::pow(0.1 * double(p.scale) * 2.50662827, 3);
        wanted += own;
        wanted_scattered += own * glm::dvec3(p.albedo);
    }
    EXPECT_NEAR(mass, wanted, 0.01 * wanted);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(scattered[c], wanted_scattered[c], 0.01 * wanted_scattered[c]);
}

TEST(LatticeOfTetrahedra, IsReadBackAsItWas) {
    Lattice lattice = latticeOf(pair(), 1, 8);
    const PointCloud near = parsePly(plyOf(lattice, glm::dvec3(0)), "l.ply", {}, {.tetrahedra = true});
    EXPECT_EQ(near.position, std::vector<glm::vec3>(lattice.position.begin(), lattice.position.end()));
    EXPECT_EQ(near.sigma_t, lattice.sigma_t);
    EXPECT_EQ(near.albedo, lattice.albedo);
    EXPECT_EQ(near.tetrahedra, lattice.corners);
    const glm::dvec3 origin(1e6, 0, -2e6);
    const PointCloud far = parsePly(plyOf(lattice, origin), "l.ply", {.origin = origin}, {.tetrahedra = true});
    for (size_t i = 0; i < far.position.size(); ++i) EXPECT_LT(glm::distance(far.position[i], near.position[i]), 1e-6f);

    std::vector<gpu::Particle> grey = pair();
    grey[1].albedo = grey[0].albedo;
    EXPECT_TRUE(latticeOf(grey, 1, 8).albedo.empty());
}

std::string errorOf(const std::vector<gpu::Particle>& particles, uint32_t cells) {
    try {
        latticeOf(particles, 1, cells);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "no error";
}

TEST(LatticeOfTetrahedra, RefusalsAreOneLine) {
    EXPECT_NE(errorOf({}, 16).find("no particles"), std::string::npos);
    std::vector<gpu::Particle> clear = pair();
    for (gpu::Particle& p : clear) p.sigma_t = 0;
    EXPECT_NE(errorOf(clear, 16).find("no extinction"), std::string::npos);
    EXPECT_NE(errorOf({pair()[0]}, 100).find("--cells 100 makes "), std::string::npos);
}

} // namespace
} // namespace brume::bench

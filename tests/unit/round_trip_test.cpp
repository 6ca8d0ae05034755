// Particles to voxels and back: PLY, VDB, PLY, and PLY, NRRD.
#include <cmath>
#include <fstream>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "common/ply/ply.h"
#include "common/volume/volume.h"
#include "tests/unit/ply_file.h"
#include "tools/import/export.h"
#include "tools/import/import.h"

namespace brume::volumes::round_trip_test {
namespace {

namespace fs = std::filesystem;

constexpr double kVoxel = 0.125; // m
constexpr double kError = 0.02;  // that the import is allowed
// Relative RMSE of depths through what is trilinear between voxels: sqrt(2) / 12 (voxel / deviation)^2.
constexpr double kTrilinear = 0.01;

// Numbers in [0, 1), the same everywhere.
struct Random {
    uint64_t state = 1;
    double operator()() {
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        return double(state >> 11) / 9007199254740992.0;
    }
};

// Particles 2.5 to 5 voxels in deviation along their axes, as a file.
std::string cloudFile(bool ellipsoids) {
    Random random;
    std::string points, properties = "property float scale\nproperty float sigma_t\n";
    if (ellipsoids)
        for (const char* axis : {"a", "b", "c"})
            for (const char* along : {"x", "y", "z"})
                properties += std::string("property float axis_") + axis + '_' + along + '\n';
    for (int i = 0; i < 12; ++i) {
        const double x = 2 * random(), y = 3 * random(), z = 4 * random(), size = 1 + random();
        const double longest = 5 * kVoxel * 10 / 1.6, scale = ellipsoids ? longest : longest / 2 * size;
        points += fmt::format("{} {} {} {} {}", x - 1, y, z + 5, scale, 0.1 + random());
        if (ellipsoids) {
            const double a = random(), b = random(), c = random(), d = 0.1 + random();
            const glm::dmat3 turn = glm::mat3_cast(glm::normalize(glm::dquat(d, a - 0.5, b - 0.5, c - 0.5)));
            for (const glm::dvec3& axis : {turn[0], turn[1] * 0.5, turn[2] * (0.5 * size)})
                points += fmt::format(" {} {} {}", axis.x, axis.y, axis.z);
        }
        points += '\n';
    }
    return test::asciiPly(properties, points);
}

// The particles in metres.
std::vector<Gaussian> particlesIn(const std::string& bytes) {
    ExportSettings metres;
    metres.voxel = 1;
    return particlesOf(bytes, "cloud.ply", metres, [](const std::string& line) { ADD_FAILURE() << line; }).gaussians;
}

// Of a vector from a Gaussian's centre, along its axes.
glm::dvec3 deviationsOf(const Gaussian& gaussian, glm::dvec3 x) {
    if (!gaussian.axes) return x / gaussian.deviation;
    return glm::inverse(*gaussian.axes) * x / gaussian.deviation;
}

double valueAt(const std::vector<Gaussian>& gaussians, glm::dvec3 place) {
    double sum = 0;
    for (const Gaussian& one : gaussians) {
        const glm::dvec3 y = deviationsOf(one, place - one.centre);
        sum += one.peak * std::exp(-0.5 * glm::dot(y, y));
    }
    return sum;
}

// The optical depth of a line.
double depthAlong(const std::vector<Gaussian>& gaussians, glm::dvec3 from, glm::dvec3 way) {
    double sum = 0;
    for (const Gaussian& one : gaussians) {
        const glm::dvec3 y = deviationsOf(one, from - one.centre), v = deviationsOf(one, way);
        const double along = glm::dot(y, v), squared = glm::dot(v, v);
        sum += one.peak * std::sqrt(2 * std::numbers::pi / squared) *
               std::exp(-0.5 * (glm::dot(y, y) - along * along / squared));
    }
    return sum;
}

double massOfAll(const std::vector<Gaussian>& gaussians) {
    double sum = 0;
    for (const Gaussian& one : gaussians) sum += massOf(one);
    return sum;
}

struct Kind {
    bool ellipsoids, z_up;
};

struct RoundTrip : testing::TestWithParam<Kind> {
    fs::path folder = fs::path(testing::TempDir()) / "brume-round-trip";
    std::string cloud = cloudFile(GetParam().ellipsoids);
    std::vector<Gaussian> truth = particlesIn(cloud);

    RoundTrip() {
        fs::create_directories(folder);
        std::ofstream(folder / "cloud.ply") << cloud;
    }
    ~RoundTrip() override { fs::remove_all(folder); }

    void exported(const char* name) const {
        ExportSettings settings;
        settings.in = folder / "cloud.ply", settings.out = folder / name;
        settings.voxel = kVoxel, settings.least = 1e-6, settings.z_up = GetParam().z_up;
        std::vector<std::string> said;
        exportFiles(settings, [&](const std::string& line) { said.push_back(line); });
        EXPECT_EQ(said.size(), 1u) << "no mass is lost";
    }
};

TEST_P(RoundTrip, OfVdbKeepsMassAndDepth) {
    exported("cloud.vdb");
    ImportSettings settings;
    settings.in = folder / "cloud.vdb", settings.out = folder / "again.ply";
    settings.placing.z_up = GetParam().z_up, settings.fit.error = kError;
    EXPECT_TRUE(importFiles(settings, [](const std::string&) {}).kept);
    const std::vector<Gaussian> again = particlesIn(plyBytes(settings.out));
    EXPECT_NEAR(massOfAll(again) / massOfAll(truth), 1, 0.01);
    Random random;
    double squares = 0, errors = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 from(2 * random() - 1, 3 * random(), 5 + 4 * random());
        const double a = random(), b = random(), c = random();
        const glm::dvec3 way = glm::normalize(glm::dvec3(a, b, c) - 0.5);
        const double depth = depthAlong(truth, from, way);
        squares += depth * depth;
        errors += std::pow(depthAlong(again, from, way) - depth, 2);
    }
    EXPECT_LT(std::sqrt(errors / squares), kError + kTrilinear);
}

TEST_P(RoundTrip, OfNrrdHasTheSumAtTheVoxels) {
    exported("cloud.nrrd");
    const brume::Volume volume =
        loadVolume(folder / "cloud.nrrd", {.up = GetParam().z_up ? "z" : "y"}, uint64_t(1) << 24);
    EXPECT_NEAR(volume.spacing, kVoxel, 1e-9);
    double peak = 0, worst = 0, mass = 0;
    for (int z = 0; z < int(volume.size.z); ++z)
        for (int y = 0; y < int(volume.size.y); ++y)
            for (int x = 0; x < int(volume.size.x); ++x) {
                const double there = double(volume.at({x, y, z}));
                const double wanted = valueAt(truth, volume.origin + volume.spacing * glm::dvec3(x, y, z));
                peak = std::max(peak, wanted), worst = std::max(worst, std::abs(there - wanted));
                mass += there * std::pow(kVoxel, 3);
            }
    EXPECT_LT(worst, 1e-4 * peak);
    EXPECT_NEAR(mass / massOfAll(truth), 1, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Kinds, RoundTrip, testing::Values(Kind{false, false}, Kind{true, true}),
                         [](const auto& kind) { return kind.param.ellipsoids ? "EllipsoidsZUp" : "Balls"; });

} // namespace
} // namespace brume::volumes::round_trip_test

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/scene_limits.h"
#include "common/volume/volume.h"
#include "server/sim/layout.h"

namespace brume {
namespace {

constexpr size_t kMostParticles = 32768;
// Deviation of a particle over the side of its cube. From the least on its support holds the cube. With the most the
// sum of particles hardly ripples.
constexpr double kLeastWidth = 0.3, kMostWidth = 0.6;
constexpr double kSqrt2Pi = 2.5066282746310002;

// The voxels of one cube.
struct Cube {
    double mass = 0;      // sum of extinctions
    glm::dvec3 moment{0}; // and times their places, in voxels
};

std::vector<Cube> cubesOf(const Volume& volume, uint32_t side) {
    const glm::uvec3 count = (volume.size + side - 1u) / side;
    std::vector<Cube> cubes(size_t(count.x) * count.y * count.z);
    size_t at = 0;
    for (uint32_t z = 0; z < volume.size.z; ++z)
        for (uint32_t y = 0; y < volume.size.y; ++y)
            for (uint32_t x = 0; x < volume.size.x; ++x) {
                const auto extinction = double(volume.extinction[at++]);
                Cube& cube = cubes[(size_t(z / side) * count.y + y / side) * count.x + x / side];
                cube.mass += extinction;
                cube.moment += extinction * glm::dvec3(x, y, z);
            }
    std::erase_if(cubes, [](const Cube& cube) { return !(cube.mass > 0); });
    return cubes;
}

// The deviation, in voxels, of Gaussians whose slopes change as fast as the volume's: of such a one the squares of its
// slopes along an axis sum up to 2/3 of its variance times those of its second derivatives.
double deviationOf(const Volume& volume) {
    double slopes = 0, bends = 0;
    for (int z = -1; z < int(volume.size.z); ++z)
        for (int y = -1; y < int(volume.size.y); ++y)
            for (int x = -1; x < int(volume.size.x); ++x) {
                const glm::ivec3 at(x, y, z);
                const auto here = double(volume.at(at));
                for (const glm::ivec3 step : {glm::ivec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}}) {
                    const double next = double(volume.at(at + step)), before = double(volume.at(at - step));
                    slopes += (next - here) * (next - here);
                    bends += (next - 2 * here + before) * (next - 2 * here + before);
                }
            }
    return std::sqrt(1.5 * slopes / bends);
}

} // namespace

Placement placeVolume(const Medium& medium, const Volume& volume) {
    uint32_t side = 4;
    std::vector<Cube> cubes = cubesOf(volume, side);
    while (cubes.size() > kMostParticles) cubes = cubesOf(volume, side *= 2);
    const double deviation = volume.spacing * std::clamp(deviationOf(volume), kLeastWidth * side, kMostWidth * side);
    Placement out;
    for (const Cube& cube : cubes) {
        out.position.emplace_back(volume.origin + volume.spacing * cube.moment / cube.mass);
        out.scale.push_back(limits::kScale.clamp(float(10 * deviation / double(medium.falloff))));
        const double part = volume.spacing / (deviation * kSqrt2Pi);
        out.sigma_t.push_back(limits::kSigmaT.clamp(float(cube.mass * part * part * part)));
    }
    out.still = true;
    PointCloudFacts facts;
    facts.volume = fmt::format("{} x {} x {} voxels {:.4g} m wide, extinction up to {:.4g} 1/m", volume.size.x,
                               volume.size.y, volume.size.z, volume.spacing, std::ranges::max(volume.extinction));
    facts.notes = volume.notes;
    facts.kept = cubes.size();
    out.cloud = std::move(facts);
    return out;
}

} // namespace brume

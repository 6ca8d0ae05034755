#include "tools/import/export.h"

#include <cmath>

#include <fmt/format.h>

#include "common/ply/ply.h"
#include "tools/import/volume.h"

namespace brume::volumes {

namespace {

constexpr double kFar = kFarthest * 0.25; // voxels
constexpr double kLargest = 1000;         // deviation, voxels: the particle is 10,000 wide
constexpr double kLost = 0.01;            // part of the particles' mass that goes without saying

glm::dvec3 turned(glm::dvec3 v, bool z_up) { return z_up ? glm::dvec3(v.x, -v.z, v.y) : v; }

glm::dmat3 turned(const gpu::EllipsoidAxes& axes, bool z_up) {
    return {turned(glm::dvec3(axes.a), z_up), turned(glm::dvec3(axes.b), z_up), turned(glm::dvec3(axes.c), z_up)};
}

} // namespace

Particles particlesOf(std::string_view bytes, const std::string& name, const ExportSettings& settings, const Say& say) {
    const PointCloud cloud = parsePly(bytes, name, {}, {.axes = contentsOf(bytes, name).axes});
    if (cloud.scale.empty() || cloud.sigma_t.empty())
        throw ImportError(name + ": its points need a scale and a sigma_t");
    if (cloud.dropped > 0)
        say(fmt::format("{}: {} points are left out; the first, {}", name, cloud.dropped, cloud.first_dropped));
    Particles out;
    out.coloured = !cloud.albedo.empty();
    for (size_t i = 0; i < cloud.position.size(); ++i) {
        const double deviation = double(cloud.scale[i]) * settings.falloff / 10;
        out.gaussians.push_back({turned(glm::dvec3(cloud.position[i]), settings.z_up) / settings.voxel,
                                 deviation / settings.voxel, double(cloud.sigma_t[i]),
                                 out.coloured ? cloud.albedo[i] : glm::vec3(1)});
        Gaussian& last = out.gaussians.back();
        if (!cloud.axes.empty()) last.axes = turned(cloud.axes[i], settings.z_up);
        if (glm::any(glm::greaterThan(glm::abs(last.centre), glm::dvec3(kFar))))
            throw ImportError("a particle lies too far from the origin for so small voxels: a larger --voxel");
        if (last.deviation > kLargest)
            throw ImportError("a particle is too large for so small voxels: a larger --voxel");
    }
    return out;
}

void exportFile(const ExportSettings& settings, const Say& say) {
    std::error_code error;
    if (!std::filesystem::exists(settings.in, error)) throw ImportError(settings.in.string() + ": no such file");
    const Particles particles = particlesOf(plyBytes(settings.in), settings.in.string(), settings, say);
    if (const uint64_t voxels = blocksOf(particles.gaussians) * kInBlock; voxels > kMostVoxels)
        throw ImportError(fmt::format("{} voxels would be needed; allowed: {}: a larger --voxel", voxels, kMostVoxels));
    Raster raster = rasterised(particles.gaussians, float(settings.least), particles.coloured);
    Volume volume;
    volume.voxels = std::move(raster.voxels);
    volume.albedo = std::move(raster.albedo);
    volume.width = settings.voxel;
    volume.turn = glm::dmat3(settings.voxel);
    if (volume.voxels.active() == 0) throw ImportError("nothing is above --least");
    writeVolume(settings.out, volume);
    const double cube = settings.voxel * settings.voxel * settings.voxel;
    say(fmt::format("{}: {} particles as {} voxels; mass {:.6g} m2", settings.out.string(), particles.gaussians.size(),
                    volume.voxels.active(), volume.voxels.sum() * cube));
    double mass = 0;
    for (const Gaussian& gaussian : particles.gaussians) mass += massOf(gaussian);
    if (std::abs(volume.voxels.sum() - mass) > kLost * mass)
        say(fmt::format("the particles' mass is {:.6g} m2: some are thinner than a voxel, or below --least",
                        mass * cube));
}

} // namespace brume::volumes

// brume-export: a cloud of particles as a VDB volume.
#include <cmath>
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "common/option_range.h"
#include "common/ply/ply.h"
#include "common/scene_limits.h"
#include "tools/import/rasterise.h"
#include "tools/import/volume.h"

namespace {

using namespace brume;

struct Settings {
    std::filesystem::path in, out;
    double voxel = 0.1, least = 1e-4, falloff = 1.6; // m, 1/m, 1
    bool z_up = false;
};

void exportCloud(const Settings& settings) {
    const PointCloud cloud = loadPly(settings.in);
    if (cloud.scale.empty() || cloud.sigma_t.empty())
        throw volumes::ImportError(settings.in.string() + ": its points need a scale and a sigma_t");
    constexpr double kFar = volumes::kFarthest * 0.25; // voxels
    std::vector<volumes::Ball> balls;
    for (size_t i = 0; i < cloud.position.size(); ++i) {
        glm::dvec3 at(cloud.position[i]);
        if (settings.z_up) at = {at.x, -at.z, at.y};
        const double deviation = double(cloud.scale[i]) * settings.falloff / 10;
        balls.push_back({at / settings.voxel, deviation / settings.voxel, double(cloud.sigma_t[i]),
                         cloud.albedo.empty() ? glm::vec3(1) : cloud.albedo[i]});
        if (glm::any(glm::greaterThan(glm::abs(balls.back().centre), glm::dvec3(kFar))))
            throw volumes::ImportError("a particle lies too far from the origin for so small voxels: a larger --voxel");
        if (balls.back().deviation > 1000) // 10,000 voxels wide
            throw volumes::ImportError("a particle is too large for so small voxels: a larger --voxel");
    }
    if (const uint64_t voxels = volumes::blocksOf(balls) * volumes::kInBlock; voxels > volumes::kMostVoxels)
        throw volumes::ImportError(
            fmt::format("{} voxels would be needed; allowed: {}: a larger --voxel", voxels, volumes::kMostVoxels));
    volumes::Raster raster = volumes::rasterised(balls, float(settings.least), !cloud.albedo.empty());
    volumes::Volume volume;
    volume.voxels = std::move(raster.voxels);
    volume.albedo = std::move(raster.albedo);
    volume.width = settings.voxel;
    volume.turn = glm::dmat3(settings.voxel);
    if (volume.voxels.active() == 0) throw volumes::ImportError("nothing is above --least");
    volumes::writeVolume(settings.out, volume);
    const double side = settings.voxel;
    std::printf("%s: %zu particles as %llu voxels; mass %.6g m2\n", settings.out.c_str(), balls.size(),
                static_cast<unsigned long long>(volume.voxels.active()), volume.voxels.sum() * side * side * side);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    std::string up = "y";
    CLI::App app{
        "brume-export: a PLY file of particles as a VDB volume: grid density (1/m), and albedo if there is one."};
    app.set_version_flag("--version", BRUME_VERSION);
    app.add_option("in", settings.in, "a PLY file")->required();
    app.add_option("out", settings.out, "a VDB file")->required();
    allow(app.add_option("--voxel", settings.voxel, "width of a voxel, m")->capture_default_str(), 1e-4, 1e3);
    allow(app.add_option("--least", settings.least, "extinction (1/m) of a voxel that is left out")
              ->capture_default_str(),
          0.0, 1e3);
    allow(app.add_option("--falloff", settings.falloff, "medium.falloff of the scene")->capture_default_str(),
          limits::kFalloff.lo, limits::kFalloff.hi);
    app.add_option("--up", up, "the file's upward axis")->check(CLI::IsMember({"y", "z"}))->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    settings.z_up = up == "z";
    try {
        exportCloud(settings);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "brume-export: %s\n", e.what());
        return 1;
    }
}

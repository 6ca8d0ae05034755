#include "tools/import/export.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "common/numbered_files.h"
#include "common/ply/ply.h"
#include "common/scene_limits.h"
#include "common/text.h"
#include "tools/import/nrrd_file.h"
#include "tools/import/volume.h"

namespace brume::volumes {

namespace {

constexpr double kFar = kFarthest * 0.25; // voxels
constexpr double kLargest = 1000;         // deviation, voxels: the particle is 10,000 wide
constexpr double kLost = 0.01;            // part of the particles' mass that goes without saying
constexpr size_t kLongestHeader = 64 << 10;

glm::dvec3 turned(glm::dvec3 v, bool z_up) { return z_up ? glm::dvec3(v.x, -v.z, v.y) : v; }

glm::dmat3 turned(const gpu::EllipsoidAxes& axes, bool z_up) {
    return {turned(glm::dvec3(axes.a), z_up), turned(glm::dvec3(axes.b), z_up), turned(glm::dvec3(axes.c), z_up)};
}

// What a server and brume-import write into a comment of the header.
std::optional<double> falloffIn(std::string_view bytes) {
    constexpr std::string_view kKey = "medium.falloff = ";
    const std::string_view header = bytes.substr(0, std::min(bytes.find("end_header"), kLongestHeader));
    const size_t at = header.find(kKey);
    if (at == header.npos) return {};
    double value = 0;
    std::from_chars(header.data() + at + kKey.size(), header.data() + header.size(), value);
    return limits::kFalloff.holds(value) ? std::optional(value) : std::nullopt;
}

bool isPattern(const std::filesystem::path& file) { return file.filename().string().find('#') != std::string::npos; }

class Exporter {
public:
    Exporter(const ExportSettings& settings, const Say& say) : settings_(settings), say_(say) {}

    void cloud(std::string_view bytes, const std::string& name, const std::filesystem::path& out,
               bool may_be_empty = false) const {
        const Particles particles = particlesOf(bytes, name, settings_, say_);
        if (!fits(particles.gaussians, kMostVoxels / kInBlock))
            throw ImportError(fmt::format("more than {} voxels would be needed: a larger --voxel", kMostVoxels));
        Raster raster = rasterised(particles.gaussians, float(settings_.least), particles.coloured);
        Volume volume;
        volume.voxels = std::move(raster.voxels);
        volume.albedo = std::move(raster.albedo);
        volume.width = settings_.voxel;
        volume.turn = glm::dmat3(settings_.voxel);
        const bool nrrd = out.extension() == ".nrrd";
        if (volume.voxels.active() == 0 && (!may_be_empty || nrrd))
            throw ImportError(name + ": nothing is above --least");
        if (nrrd)
            writeNrrd(out, volume, {}, oneLine("made by brume-export from " + name));
        else
            writeVolume(out, volume);
        tell(particles, volume, out, nrrd);
    }

private:
    void tell(const Particles& particles, const Volume& volume, const std::filesystem::path& out, bool nrrd) const {
        const double cube = settings_.voxel * settings_.voxel * settings_.voxel, sum = volume.voxels.sum();
        std::string line = fmt::format("{}: {} particles as {} voxels; mass {:.6g} m2", out.string(),
                                       particles.gaussians.size(), volume.voxels.active(), sum * cube);
        if (!settings_.falloff && particles.falloff != Particles().falloff)
            line += fmt::format("; medium.falloff {:g}, as the header says", particles.falloff);
        if (nrrd && particles.coloured) line += "; the albedo is left out";
        say_(line);
        double mass = 0;
        for (const Gaussian& gaussian : particles.gaussians) mass += massOf(gaussian);
        if (std::abs(sum - mass) > kLost * mass)
            say_(fmt::format("the particles' mass is {:.6g} m2: some are thinner than a voxel, or below --least",
                             mass * cube));
    }

    const ExportSettings& settings_;
    const Say& say_;
};

} // namespace

Particles particlesOf(std::string_view bytes, const std::string& name, const ExportSettings& settings, const Say& say) {
    const bool axes = contentsOf(bytes, name).axes;
    const PointCloud cloud = parsePly(bytes, name, {}, {.axes = axes, .may_be_empty = true});
    if (!cloud.position.empty() && (cloud.scale.empty() || cloud.sigma_t.empty()))
        throw ImportError(name + ": its points need a scale and a sigma_t");
    if (cloud.dropped > 0)
        say(fmt::format("{}: {} points are left out; the first, {}", name, cloud.dropped, cloud.first_dropped));
    Particles out;
    out.coloured = !cloud.albedo.empty();
    out.falloff = settings.falloff.value_or(falloffIn(bytes).value_or(out.falloff));
    for (size_t i = 0; i < cloud.position.size(); ++i) {
        const double deviation = double(cloud.scale[i]) * out.falloff / 10;
        out.gaussians.push_back({turned(glm::dvec3(cloud.position[i]), settings.z_up) / settings.voxel,
                                 deviation / settings.voxel, double(cloud.sigma_t[i]),
                                 out.coloured ? cloud.albedo[i] : glm::vec3(1)});
        Gaussian& last = out.gaussians.back();
        if (axes) last.axes = turned(cloud.axes[i], settings.z_up);
        if (glm::any(glm::greaterThan(glm::abs(last.centre), glm::dvec3(kFar))))
            throw ImportError("a particle lies too far from the origin for so small voxels: a larger --voxel");
        if (last.deviation > kLargest)
            throw ImportError("a particle is too large for so small voxels: a larger --voxel");
    }
    return out;
}

void exportFiles(const ExportSettings& settings, const Say& say) {
    const Exporter exporter(settings, say);
    if (isPattern(settings.in) != isPattern(settings.out))
        throw ImportError("a # for each digit of a frame's number is allowed in both names or in none");
    if (isPattern(settings.in)) {
        for (const auto& [number, in] : numberedFiles(settings.in))
            exporter.cloud(plyBytes(in), in.string(), numberedFile(settings.out, number), true);
        return;
    }
    std::error_code error;
    if (!std::filesystem::exists(settings.in, error)) throw ImportError(settings.in.string() + ": no such file");
    exporter.cloud(plyBytes(settings.in), settings.in.string(), settings.out);
}

void exportBytes(std::string_view bytes, const std::string& name, const ExportSettings& settings, const Say& say) {
    if (isPattern(settings.out))
        throw ImportError("a # for each digit of a number is allowed for numbered files alone");
    Exporter(settings, say).cloud(bytes, name, settings.out);
}

} // namespace brume::volumes

#include "tools/import/import.h"

#include <chrono>
#include <cmath>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include "common/numbered_files.h"
#include "common/scene_limits.h"
#include "tools/import/nrrd_file.h"

namespace brume::volumes {

namespace {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string missed(const Fit& fit, const FitSettings& settings) {
    std::string remedy = "a larger --error";
    if (!fit.all && double(settings.most) < limits::kCount.hi) remedy = "a larger --most, or " + remedy;
    return fmt::format("error {:.3g} with {} particles; allowed {:g}: {}", fit.error.worst(), fit.kernels.size(),
                       settings.error, remedy);
}

// Vectors at voxels half as wide. One between voxels is that of the densest around.
std::vector<glm::vec3> halved(const std::vector<glm::vec3>& vectors, const Voxels& voxels, const Voxels& fine) {
    std::vector<glm::vec3> out(vectors.empty() ? 0 : fine.values().size(), glm::vec3(0));
    for (size_t i = 0; i < out.size(); ++i) {
        const glm::ivec3 voxel = voxelOf(fine.blocks()[i / kInBlock], i % kInBlock);
        float most = 0;
        for (int n = 0; n < 8; ++n) {
            const glm::ivec3 near = (voxel >> 1) + ((voxel & 1) & glm::ivec3(n & 1, n >> 1 & 1, n >> 2));
            if (voxels.at(near) <= most) continue;
            most = voxels.at(near);
            out[i] = vectors[voxels.find(near >> 3) * kInBlock + inBlock(near)];
        }
    }
    return out;
}

// The same volume with voxels half as wide.
Volume halved(const Volume& volume) {
    Volume out = volume;
    out.voxels = halved(volume.voxels);
    out.turn *= 0.5;
    out.width *= 0.5;
    out.albedo = halved(volume.albedo, volume.voxels, out.voxels);
    out.velocity = halved(volume.velocity, volume.voxels, out.voxels);
    return out;
}

class Importer {
public:
    Importer(const ImportSettings& settings, const std::function<void(const std::string&)>& say)
        : settings_(settings), say_(say) {}

    void file(const std::filesystem::path& in, const std::filesystem::path& out, CellIds* ids) {
        const double begun = seconds();
        VolumeWanted wanted = settings_.wanted;
        if (!ids) wanted.velocity = "none"; // a cloud of one file stands still
        Volume volume = readVolume(in, wanted);
        if (!std::ofstream(out, std::ios::app)) throw ImportError(out.string() + ": cannot be written");
        for (const std::string& note : volume.notes) say_(in.string() + ": " + note);
        if (ids) alike(in, volume);
        const uint64_t voxels = volume.voxels.active();
        if (out.extension() == ".nrrd") {
            writeNrrd(out, volume, settings_.placing, "made by brume-import from " + in.filename().string());
            say_(fmt::format("{}: {} voxels above 0{}", out.string(), voxels,
                             volume.albedo.empty() ? "" : "; the albedo is left out"));
            result.voxels = voxels;
            return;
        }
        const double mass = volume.voxels.sum() * settings_.placing.density * std::pow(widthOf(volume), 3);
        Fit fit = fitted(volume);
        // Where a Gaussian for each voxel is not enough, what lies between voxels is followed, too.
        if (!fit.kept && fit.all && volume.voxels.active() * 8 < kMostVoxels) {
            volume = halved(volume);
            fit = fitted(volume);
        }
        const Cloud cloud = cloudOf(volume, fit.kernels, settings_.placing, ids);
        writeCloud(out, cloud,
                   {"made by brume-import from " + in.filename().string(),
                    fmt::format("relative RMSE of optical depth {:.4g}, of what is stopped {:.4g}, of pictures {:.4g}",
                                fit.error.depth, fit.error.opacity, fit.error.picture),
                    fmt::format("for medium.falloff = {:g}; a value of 1 is {:g} 1/m", settings_.placing.falloff,
                                settings_.placing.density)});
        say_(fmt::format("{}: {} particles for {} voxels, {:.1f} times fewer; error {:.3g} of optical depth, {:.3g} of "
                         "what is stopped, {:.3g} of pictures; mass {:.6g} m2; {:.1f} s",
                         out.string(), fit.kernels.size(), voxels, double(voxels) / double(fit.kernels.size()),
                         fit.error.depth, fit.error.opacity, fit.error.picture, mass, seconds() - begun));
        if (!fit.kept) say_(missed(fit, settings_.fit));
        result.kept = result.kept && fit.kept;
        result.voxels = voxels;
        result.points = fit.kernels.size();
        result.error = fit.error;
    }

    Imported result{.kept = true, .error = {}};

private:
    double widthOf(const Volume& volume) const { return volume.width * settings_.placing.scale; } // of a voxel, m

    Fit fitted(const Volume& volume) const {
        FitSettings how = settings_.fit;
        how.per_value = depthPerValue(volume, settings_.placing);
        return fit(volume.voxels, how);
    }

    // All files of a sequence have the same properties: the first one's.
    void alike(const std::filesystem::path& in, Volume& volume) {
        if (!first_) first_ = {!volume.albedo.empty(), !volume.velocity.empty()};
        const auto as = [&](bool wanted, const char* what, const char* instead, glm::vec3 value, auto& vectors) {
            if (!vectors.empty() == wanted) return;
            say_(in.string() + (wanted ? fmt::format(": no {}, unlike in the first file; {} is taken", what, instead)
                                       : fmt::format(": the {} is ignored, as the first file has none", what)));
            vectors.assign(wanted ? volume.voxels.values().size() : 0, value);
        };
        as(first_->albedo, "albedo", "1", glm::vec3(1), volume.albedo);
        as(first_->velocity, "velocity", "0", glm::vec3(0), volume.velocity);
    }

    const ImportSettings& settings_;
    const std::function<void(const std::string&)>& say_;
    struct Vectors {
        bool albedo, velocity; // True: a file has them
    };
    std::optional<Vectors> first_; // of the first file
};

} // namespace

Imported importFiles(const ImportSettings& settings, const std::function<void(const std::string&)>& say) {
    Importer importer(settings, say);
    const bool many = settings.in.filename().string().find('#') != std::string::npos;
    if (many != (settings.out.filename().string().find('#') != std::string::npos))
        throw ImportError("a # for each digit of a frame's number is allowed in both names or in none");
    if (!many) {
        importer.file(settings.in, settings.out, nullptr);
        return importer.result;
    }
    if (settings.fit.ellipsoids) throw ImportError("a sequence has no ellipsoids: leave out --ellipsoids");
    CellIds ids;
    for (const auto& [number, in] : numberedFiles(settings.in))
        importer.file(in, numberedFile(settings.out, number), &ids);
    return importer.result;
}

} // namespace brume::volumes

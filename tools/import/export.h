// PLY files of particles as volumes.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/rasterise.h"

namespace brume::volumes {

struct ExportSettings {
    std::filesystem::path in, out; // with a run of #: a sequence. Of .nrrd the voxels alone, otherwise VDB
    double voxel = 0.1;            // m, its width
    double least = 1e-4;           // 1/m; voxels below it are left out
    std::optional<double> falloff; // of the scene: sizes follow from it; none: what a file's comment says, or 1.6
    bool z_up = false;             // True: (x, y, z) of the scene becomes (x, -z, y)
};

using Say = std::function<void(const std::string&)>; // called with lines for people

struct Particles {
    std::vector<Gaussian> gaussians; // in voxels; with axes if the file has them
    bool coloured = false;
    double falloff = 1.6; // that was taken
};

// Reads the bytes of a PLY file, which messages call `name`. Throws SceneError for what is no such file, and
// ImportError for particles without a size or an extinction, too far away, or too large.
Particles particlesOf(std::string_view bytes, const std::string& name, const ExportSettings& settings, const Say& say);

// Both throw ImportError or SceneError, one line, for what cannot be done. A file of a sequence may be without
// particles if its volume is a VDB.
void exportFiles(const ExportSettings& settings, const Say& say);
// From bytes in place of a file; `settings.in` is not used.
void exportBytes(std::string_view bytes, const std::string& name, const ExportSettings& settings, const Say& say);

} // namespace brume::volumes

// A VDB file, or a numbered sequence of them, as PLY.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tools/import/cloud_file.h"
#include "tools/import/fit.h"
#include "tools/import/volume.h"

namespace brume::volumes {

struct ImportSettings {
    std::filesystem::path in, out; // with a run of #: a sequence
    VolumeWanted wanted;
    Placing placing;
    FitSettings fit; // per_value is not used: it follows from the volume
};

struct Imported {
    bool kept = false;               // True: the error of every frame is within the bound
    uint64_t voxels = 0, points = 0; // of the last frame
    SeenError error;                 // of the last frame
};

// Calls say() with lines for people: for each file its notes, then what was fitted. Throws ImportError, and SceneError
// for a sequence without files.
Imported importFiles(const ImportSettings& settings, const std::function<void(const std::string&)>& say);

} // namespace brume::volumes

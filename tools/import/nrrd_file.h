// The voxels of a volume themselves, as a file for medium.layout = "volume".
#pragma once

#include <filesystem>
#include <string>

#include "tools/import/cloud_file.h"

namespace brume::volumes {

// The box of all voxels above 0, as extinctions (1/m) in metres. Throws ImportError for voxels that do not lie along
// the axes, and if the file cannot be written.
void writeNrrd(const std::filesystem::path& file, const Volume& volume, const Placing& placing,
               const std::string& comment);

} // namespace brume::volumes

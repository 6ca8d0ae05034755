// The scene that an uploaded file becomes: a point cloud or tetrahedra (PLY), or a volume (NRRD).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/ply/upload_frame.h"
#include "common/scene.h"

namespace brume {

// The ending of the name that such a file is kept under: ".ply", or ".nrrd" for what begins as a NRRD does.
std::string endingOf(const std::string& bytes);

struct UploadedScene {
    Scene scene;                    // with a camera that sees all of it
    std::vector<std::string> notes; // choices that the file left open, one line each
};

// `file`: the scene's file, beside which the bytes are kept under its name. Throws SceneError for bytes that cannot be
// shown.
UploadedScene sceneOfUpload(const std::string& bytes, const UploadOptions& options, const std::filesystem::path& file);

} // namespace brume

// The camera of a scene file, with its key views.
#pragma once

#include <filesystem>
#include <vector>

#include "common/scene.h"
#include "common/setting_reader.h"

namespace brume {

// Of the table [camera]. `by_points`: becomes true where it says nothing of the camera but key views.
void readCamera(TableReader& in, const SettingReader& read, Scene& out, bool& by_points);

// The key views of a file: of a scene's [[camera.key]], of [[key]] in a TOML file that has nothing else, or of a JSON
// array of objects with the same names. There is one at least. Throws SceneError, one line.
std::vector<CameraKey> loadCameraKeys(const std::filesystem::path& file);

} // namespace brume

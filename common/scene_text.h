// A scene's text apart from its file, for recordings: what was loaded can be loaded again after the file has changed.
#pragma once

#include "common/scene.h"

namespace brume {

// Throws SceneError when the file cannot be read or is larger than 1 MiB.
std::string sceneText(const std::filesystem::path& file);
// As loadScene(), of that text; `file` gives the scene's name, the folder of its particle file, and stands in errors.
Scene sceneOf(const std::string& text, const std::filesystem::path& file, std::span<const std::string> overrides = {});

// The scene as a file that loads as the same scene: what differs from the defaults. Directions may differ by their
// rounding. Files of particles and meshes stand there without their folders: they lie beside the scene's file.
std::string sceneToml(const Scene& scene);

} // namespace brume

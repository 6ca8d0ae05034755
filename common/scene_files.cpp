// Which scenes there are, and where.
#include <algorithm>

#include "common/scene.h"

namespace brume {

std::vector<std::string> sceneNames(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
        if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

std::filesystem::path findScene(const std::string& name_or_path, const std::filesystem::path& scene_dir) {
    if (name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".toml")) return name_or_path;
    std::filesystem::path found = scene_dir / (name_or_path + ".toml");
    std::error_code ignored; // a folder that cannot be read offers no scenes
    if (std::filesystem::is_regular_file(found, ignored)) return found;
    std::string list;
    for (const std::string& name : sceneNames(scene_dir)) list += (list.empty() ? "" : ", ") + name;
    throw SceneError("no scene \"" + name_or_path + "\" in " + scene_dir.string() +
                     "; there are: " + (list.empty() ? "none" : list) + "; or give the path of a .toml file");
}

} // namespace brume

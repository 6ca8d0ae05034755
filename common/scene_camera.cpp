#include "common/scene_camera.h"

#include <nlohmann/json.hpp>

#include "common/scene_text.h"
#include "common/text.h"
#include "common/toml_text.h"

namespace brume {
namespace {

void readKeys(TableReader& in, const SettingReader& read, std::vector<CameraKey>& out, const glm::dvec3& origin) {
    in.tables("key", out, limits::kCameraKeys, [&](TableReader& r, CameraKey& key) {
        read.readTable(r, "camera.key", {.key = &key}, &origin);
        if (!(glm::distance(key.position, key.target) > 1e-3f))
            r.fail("target", "is where the camera stands", "any place further than 1 mm from the key's position");
        if (&key == out.data() && r.has("seconds")) r.fail("seconds", "no key is before the first one", "no seconds");
    });
}

// A JSON array of objects as [[key]] tables: numbers, texts and arrays of them are written alike in both.
std::string tomlOf(const std::string& json, const std::string& file) {
    const auto flat = [](int depth, auto, const auto&) { return depth <= 3; }; // deeper values are left out
    const auto all = nlohmann::json::parse(json, flat, false);
    std::string text;
    bool objects = all.is_array() && all.size() <= size_t(limits::kCameraKeys.hi);
    for (size_t i = 0; objects && i < all.size(); ++i) {
        objects = all[i].is_object();
        text += "[[key]]\n";
        for (const auto& [name, value] : all[i].items())
            text += nlohmann::json(name).dump() + " = " + value.dump() + '\n';
    }
    if (!objects)
        throw SceneError(oneLine(file) + ": no JSON array of key views; allowed: [{\"position\": [0, 2, 26], "
                                         "\"target\": [0, 0, 0]}, ...], at most 64");
    return text;
}

} // namespace

void readCamera(TableReader& in, const SettingReader& read, Scene& out, bool& by_points) {
    by_points = in.has("key") && !in.has("position") && !in.has("target") && !in.has("fov_y");
    read.readTable(in, "camera", {.camera = &out.camera}, &out.origin);
    if (!(glm::distance(out.camera.position, out.camera.target) > 1e-3f))
        in.fail("target", "is where the camera stands", "any place further than 1 mm from camera.position");
    readKeys(in, read, out.camera_keys, out.origin);
}

std::vector<CameraKey> loadCameraKeys(const std::filesystem::path& file) {
    const std::string name = file.string();
    std::string text = sceneText(file);
    if (file.extension() == ".json") text = tomlOf(text, name);
    toml::table root;
    try {
        root = parseToml(text, name);
    } catch (const toml::parse_error& error) {
        throw SceneError(oneLine(name + ':' + std::to_string(error.source().begin.line) + ": " + syntaxProblem(error)));
    }
    std::vector<CameraKey> keys;
    const SettingReader read(file.parent_path());
    TableReader top(root, "", name);
    glm::dvec3 origin(0);
    if (!top.isAuto("origin")) top.vector("origin", origin, limits::kOrigin);
    if (top.has("key"))
        readKeys(top, read, keys, origin);
    else if (const toml::table* camera = root["camera"].as_table()) {
        TableReader in(*camera, "camera", name);
        readKeys(in, read, keys, origin);
    }
    if (keys.empty())
        throw SceneError(oneLine(name) + ": no key views; allowed: [[camera.key]] in a scene, or [[key]]");
    return keys;
}

} // namespace brume

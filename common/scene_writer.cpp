#include <algorithm>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "common/scene_text.h"
#include "common/settings.h"

namespace brume {
namespace {

std::string quoted(const std::string& text) {
    std::ostringstream out;
    out << toml::value<std::string>(text);
    return out.str();
}

template <class Vector>
std::string listOf(const Vector& v) {
    return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
}

// One value as a scene file has it. Numbers have as many digits as it takes to read the same number again.
struct Written {
    const SceneSetting& setting;
    const glm::dvec3& origin; // that places count from; 0 for displacements

    std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
    std::string operator()(const float* value) const {
        if (setting.form == Form::or_auto && *value == kAuto) return "\"auto\"";
        if (setting.form == Form::height) return fmt::format("{}", double(*value) + origin.y);
        return fmt::format("{}", *value);
    }
    std::string operator()(const uint32_t* value) const {
        return setting.form == Form::or_auto && *value == kAuto ? "\"auto\"" : fmt::format("{}", *value);
    }
    std::string operator()(const uint64_t* value) const { return fmt::format("{}", *value); }
    std::string operator()(const glm::vec3* value) const {
        return setting.form == Form::place ? listOf(glm::dvec3(*value) + origin) : listOf(*value);
    }
    std::string operator()(const glm::dvec3* value) const { return listOf(*value); }
    std::string operator()(const Range* value) const { return fmt::format("[{}, {}]", value->lo, value->hi); }
    std::string operator()(const std::string* value) const { return quoted(*value); }
    std::string operator()(const Layout* value) const { return quoted(std::string(setting.choices[size_t(*value)])); }
    std::string operator()(const std::filesystem::path* value) const { return quoted(value->filename().string()); }
};

// True: both are directions, and differ in their length alone. Loading makes them unit.
bool sameDirection(const SceneSetting& setting, const Member& a, const Member& b) {
    if (setting.form != Form::direction) return false;
    const glm::vec3 apart = glm::normalize(*std::get<glm::vec3*>(a)) - glm::normalize(*std::get<glm::vec3*>(b));
    return glm::length(apart) < 1e-6f;
}

class Writer {
public:
    Writer(const Scene& scene, std::string& out) : scene_(scene), out_(out) {}

    void write() {
        Scene scene = scene_, by_default;
        by_default.name.clear();
        table("", {.scene = &scene}, {.scene = &by_default}, Head::none);
        if (scene.lights.empty()) out_ += "light = []\n";
        list("light", scene.lights, &SceneParts::light);
        medium(scene.medium);
        list("fog", scene.fogs, &SceneParts::fog);
        table("simulation", {.simulation = &scene.simulation}, {.simulation = &by_default.simulation});
        list("plane", scene.planes, &SceneParts::plane);
        table("objects", {.objects = &scene.objects}, {.objects = &by_default.objects});
        scene.boxes.resize(scene.boxes.size() - scene.laid_out_boxes);
        scene.spheres.resize(scene.spheres.size() - scene.laid_out_spheres);
        list("box", scene.boxes, &SceneParts::box);
        list("sphere", scene.spheres, &SceneParts::sphere);
        list("mesh", scene.meshes, &SceneParts::mesh);
        list("glass", scene.glasses, &SceneParts::glass);
        table("sky", {.sky = &scene.sky}, {.sky = &by_default.sky});
        table("camera", {.camera = &scene.camera}, {.camera = &by_default.camera});
        keys(scene.camera_keys);
        std::string_view last;
        for (const SceneSetting& setting : sceneSettings()) // render, and the tables of one method each
            if (const std::string_view name = setting.table();
                name.starts_with("render") && name != std::exchange(last, name))
                table(name, {.render = &scene.render}, {.render = &by_default.render});
    }

private:
    enum class Head { none, table, element };

    // Settings of one table that are not as `by_default`. `head`: what stands above them. A table without such
    // settings is left out, an element of a list is not.
    void table(std::string_view name, const SceneParts& parts, const SceneParts& by_default, Head head = Head::table) {
        std::string lines;
        const bool displaced = name == "medium" && (isFromFiles() || parts.medium->layout == Layout::live);
        const glm::dvec3 origin = displaced ? glm::dvec3(0) : scene_.origin;
        for (const SceneSetting& setting : sceneSettings()) {
            if (setting.table() != name || isNotSaid(setting)) continue;
            if (parts.light && !has(*parts.light, setting.key())) continue;
            const Written written{setting, origin};
            const std::string value = std::visit(written, setting.member(parts));
            const bool same = value == std::visit(written, setting.member(by_default)) ||
                              sameDirection(setting, setting.member(parts), setting.member(by_default));
            if (!same || isAlwaysSaid(setting)) lines += fmt::format("{} = {}\n", setting.key(), value);
        }
        if (head == Head::table && lines.empty()) return;
        if (head == Head::table) out_ += fmt::format("\n[{}]\n", name);
        if (head == Head::element) out_ += fmt::format("\n[[{}]]\n", name);
        out_ += lines;
    }

    template <class T>
    void list(std::string_view name, std::vector<T>& elements, T* SceneParts::*part) {
        for (T& element : elements) {
            T by_default{};
            SceneParts parts, defaults;
            parts.*part = &element;
            defaults.*part = &by_default;
            table(name, parts, defaults, Head::element);
        }
    }

    // The first key has no seconds.
    void keys(std::vector<CameraKey>& keys) {
        if (!keys.empty()) keys.front().seconds = CameraKey{}.seconds;
        list("camera.key", keys, &SceneParts::key);
    }

    void medium(Medium& medium) {
        Medium by_default;
        const SceneParts parts{.medium = &medium}, defaults{.medium = &by_default};
        table("medium", parts, defaults);
        if (medium.layout == Layout::emitter) table("medium.emitter", parts, defaults);
    }

    bool isFromFiles() const { return brume::isFromFiles(scene_.medium.layout); }

    // Keys that the medium's layout does not allow, or that would say what the server found out by itself.
    bool isNotSaid(const SceneSetting& setting) const {
        const Medium& medium = scene_.medium;
        if (setting.path == "medium.count") return isFromFiles() || medium.layout == Layout::none;
        if (setting.path == "medium.scale") return medium.scale_by_spacing;
        if (setting.path == "medium.extinction") return medium.extinction_by_depth;
        if (setting.path == "medium.file") return !isFromFiles();
        return false;
    }

    // Keys whose absence means something else than their default.
    bool isAlwaysSaid(const SceneSetting& setting) const {
        return setting.path == "name" || (setting.path == "medium.scale" && isFromFiles());
    }

    const Scene& scene_;
    std::string& out_;
};

} // namespace

std::string sceneToml(const Scene& scene) {
    std::string text;
    Writer(scene, text).write();
    return text;
}

} // namespace brume

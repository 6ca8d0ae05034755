// Live settings: their paths, their values, and changes of them.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "common/settings.h"

namespace brume {
namespace {

struct Read {
    template <class T>
    SettingValue operator()(const T* member) const {
        if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, float> || std::is_same_v<T, uint32_t> ||
                      std::is_same_v<T, glm::vec3> || std::is_same_v<T, std::string>)
            return *member;
        else
            throw std::logic_error("a live setting of a type that no command has");
    }
};

// Gives a member a value of its type.
struct Assign {
    const SceneSetting& setting;

    void operator()(bool* to, bool value) const { *to = value; }
    void operator()(float* to, float value) const {
        if (std::isfinite(value)) *to = setting.allowed.clamp(value);
    }
    void operator()(uint32_t* to, uint32_t value) const {
        *to = static_cast<uint32_t>(std::clamp<double>(value, setting.allowed.lo, setting.allowed.hi));
    }
    void operator()(glm::vec3* to, glm::vec3 value) const {
        for (int i = 0; i < 3; ++i) {
            if (!std::isfinite(value[i])) return;
            value[i] = setting.allowed.clamp(value[i]);
        }
        const float length = glm::length(value);
        if (setting.form != Form::direction) *to = value;
        if (setting.form == Form::direction && length > 1e-6f) *to = value / length;
    }
    void operator()(std::string* to, const std::string& value) const {
        const auto& names = setting.choices;
        const bool known = names.empty() || std::find(names.begin(), names.end(), value) != names.end();
        if (known && !value.empty() && value.size() <= kLongestName) *to = value;
    }
    template <class Member, class Value>
    void operator()(Member, const Value&) const {} // of another type
};

const SceneSetting* checked(const SceneSetting* setting, std::string_view path, const SettingValue& value) {
    if (!setting) throw std::invalid_argument(std::string(path) + " is not a live setting");
    if (value.index() != defaultOf(*setting).index())
        throw std::invalid_argument(std::string(path) + " has values of another type");
    return setting;
}

} // namespace

std::string_view nameOf(SceneList list) { return liveSettings(list).front()->table(); }

std::optional<SceneList> sceneList(std::string_view name) {
    const auto* const found = std::ranges::find(kSceneLists, name, nameOf);
    return found == std::end(kSceneLists) ? std::nullopt : std::optional(*found);
}

std::optional<ElementPath> elementPath(std::string_view path) {
    for (const SceneList list : kSceneLists) {
        const std::string_view name = nameOf(list);
        if (!path.starts_with(name) || path.substr(name.size(), 1) != "[") continue;
        const std::string_view rest = path.substr(name.size() + 1);
        const size_t digits = rest.find(']');
        if (digits == rest.npos || digits < 1 || digits > 6) return {};
        ElementPath found{list, 0, rest.substr(digits + 1)};
        if (std::from_chars(rest.data(), rest.data() + digits, found.element).ptr != rest.data() + digits) return {};
        if (found.key.empty()) return found;
        if (found.key[0] != '.' || found.key.size() == 1) return {};
        found.key.remove_prefix(1);
        return found;
    }
    return {};
}

const SceneSetting* liveSetting(std::string_view path) {
    const std::optional<ElementPath> at = elementPath(path);
    const auto all = at ? liveSettings(at->list) : liveSettings();
    const auto found =
        std::ranges::find_if(all, [&](auto* one) { return at ? one->key() == at->key : one->path == path; });
    return found == all.end() ? nullptr : *found;
}

const SceneSetting* elementSetting(SceneList list, std::string_view path) {
    const auto all = liveSettings(list);
    const auto found = std::ranges::find(all, path, &SceneSetting::path);
    return found == all.end() ? nullptr : *found;
}

const SceneSetting* quadratureSetting(const RenderSettings& render) {
    return liveSetting("render." + render.method + ".quadrature");
}

const SceneSetting* quadratureSetting(std::string_view quadrature) {
    for (const SceneSetting* setting : liveSettings())
        if (setting->key() == "quadrature" &&
            std::find(setting->choices.begin(), setting->choices.end(), quadrature) != setting->choices.end())
            return setting;
    return nullptr;
}

SettingValue valueOf(const SceneSetting& setting, const SceneParts& parts) {
    return std::visit(Read{}, setting.member(parts));
}

const SceneParts& defaultParts() {
    static Medium medium;
    static SimulationSettings simulation;
    static Light light;
    static Fog fog;
    static Plane plane;
    static Box box;
    static Sphere sphere;
    static Sky sky;
    static RenderSettings render;
    static const SceneParts parts{.medium = &medium,
                                  .simulation = &simulation,
                                  .light = &light,
                                  .fog = &fog,
                                  .plane = &plane,
                                  .box = &box,
                                  .sphere = &sphere,
                                  .sky = &sky,
                                  .render = &render};
    return parts;
}

SettingValue defaultOf(const SceneSetting& setting) { return valueOf(setting, defaultParts()); }

std::vector<SettingValue> defaultValues() {
    std::vector<SettingValue> values;
    for (const SceneSetting* setting : liveSettings()) values.push_back(defaultOf(*setting));
    return values;
}

Change::Change(std::string_view path, SettingValue to) : setting(checked(liveSetting(path), path, to)) {
    if (const auto at = elementPath(path)) element = at->element;
    value = std::move(to);
}

Change::Change(SceneList list, std::string_view path, SettingValue to)
    : setting(checked(elementSetting(list, path), path, to)), value(std::move(to)) {}

std::string Change::path() const {
    std::string path(setting->path);
    if (element != kNoElement) path.insert(path.find('.'), '[' + std::to_string(element) + ']');
    return path;
}

void apply(const Change& change, const SceneParts& parts) {
    std::visit(Assign{*change.setting}, change.setting->member(parts), change.value);
    if (!parts.render) return;
    IsvSettings& isv = parts.render->isv;
    isv.steps = std::min(isv.steps, static_cast<uint32_t>(stepsAllowed(isv).hi));
}

bool has(const Light& light, std::string_view key) {
    if (key == "type") return true;
    for (const std::string_view of_directional : {"to_light", "irradiance", "rotate", "rotate_axis"})
        if (key == of_directional) return !isLocal(light);
    for (const std::string_view of_spot : {"axis", "inner", "outer"})
        if (key == of_spot) return light.type == kSpot;
    return isLocal(light);
}

Limits stepsAllowed(const IsvSettings& isv) {
    return isv.quadrature == "transmittance" ? limits::kTransmittanceSteps : limits::kSteps;
}

} // namespace brume

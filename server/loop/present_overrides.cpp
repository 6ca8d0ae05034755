#include "server/loop/present_overrides.h"

#include <fmt/format.h>

namespace brume {
namespace {

struct AsToml {
    std::string operator()(glm::vec3 v) const { return fmt::format("[{},{},{}]", v.x, v.y, v.z); }
    template <class Value>
    std::string operator()(const Value& value) const {
        return fmt::format("{}", value);
    }
};

std::string tomlOf(const SceneSetting& setting, const SettingValue& value) {
    if (setting.form == Form::or_auto && (value == SettingValue(float(kAuto)) || value == SettingValue(kAuto)))
        return "auto";
    return std::visit(AsToml(), value);
}

} // namespace

std::vector<std::string> presentOverrides(const SceneFacts& facts, std::span<const SettingValue> settings,
                                          const SceneFeatures& features, const RenderSettings* way) {
    Scene present = facts.scene;
    Light sun = sunOf(present);
    const SceneParts parts{
        .medium = &present.medium, .simulation = &present.simulation, .light = &sun, .render = &present.render};
    for (size_t i = 0; i < settings.size(); ++i) apply({liveSettings()[i]->path, settings[i]}, parts);
    if (way) present.render = *way;
    // The settings may be older than the features.
    if (features.lobe != hasLobe(present.medium))
        present.medium.phase = kMixturePhase, present.medium.anisotropy = features.lobe ? 1.0f : 0.0f;
    if (features.emission != (present.medium.emission != glm::vec3(0)))
        present.medium.emission = glm::vec3(features.emission ? 1.0f : 0.0f);
    if (features.sun != (sun.irradiance != glm::vec3(0))) sun.irradiance = glm::vec3(features.sun ? 1.0f : 0.0f);

    std::vector<std::string> all;
    Scene scene = facts.scene;
    const SceneParts own{.medium = &scene.medium, .simulation = &scene.simulation, .render = &scene.render};
    for (const SceneSetting& setting : sceneSettings()) {
        const bool is_render = setting.path.starts_with("render.");
        if (!is_render && (!setting.live() || setting.in_list || setting.table() == "light")) continue;
        const SettingValue value = valueOf(setting, parts);
        if (value != valueOf(setting, own)) all.push_back(fmt::format("{}={}", setting.path, tomlOf(setting, value)));
    }
    if (!features.bodies) all.insert(all.end(), {"box=[]", "sphere=[]"});
    if (features.bodies && scene.boxes.empty() && scene.spheres.empty()) all.emplace_back("box=[{}]");
    if (!features.opaque) all.emplace_back("plane=[]");
    if (features.opaque && !features.bodies && !features.local_lights && scene.planes.empty())
        all.emplace_back("plane=[{}]");
    all.push_back(fmt::format("fog=[{}]", features.glow ? "{emission=[1,1,1]}" : features.fog ? "{}" : ""));
    all.push_back(fmt::format("light=[{{to_light={},irradiance={}}}{}]", AsToml()(sun.to_light),
                              AsToml()(sun.irradiance), features.local_lights ? ",{type='point'}" : ""));
    return all;
}

} // namespace brume

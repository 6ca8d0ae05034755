// Other values of live settings, for tests that walk the whole table.
#pragma once

#include <string>
#include <vector>

#include "common/settings.h"

namespace brume::test {

// Values that the setting does not have now: of a text all that are allowed, of a number one. That is the coarsest
// where the server chooses it: fine grids take long.
inline std::vector<SettingValue> otherValues(const SceneSetting& setting, const SettingValue& now) {
    std::vector<SettingValue> others;
    const auto add = [&](const SettingValue& value) {
        if (value != now) others.push_back(value);
    };
    const Limits slider = setting.slider();
    const auto number = [&](auto value) {
        using Number = decltype(value);
        return value == Number(slider.lo) || setting.form == Form::or_auto ? Number(slider.hi) : Number(slider.lo);
    };
    for (const std::string_view name : setting.choices) add(std::string(name));
    if (const auto* value = std::get_if<bool>(&now)) add(!*value);
    if (const auto* value = std::get_if<float>(&now)) add(number(*value));
    if (const auto* value = std::get_if<uint32_t>(&now)) add(number(*value));
    if (std::holds_alternative<glm::vec3>(now)) {
        if (setting.form != Form::direction) add(glm::vec3(0));
        add(glm::vec3(0.2f, 0.5f, 0.9f));
    }
    return others;
}

} // namespace brume::test

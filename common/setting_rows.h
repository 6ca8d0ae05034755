// What the tables of settings are written with (settings.cpp, method_settings.h).
#pragma once

#include "common/settings.h"

namespace brume::setting_rows {

// The member that is found by going from a part of the scene through one struct after another.
template <auto Part, auto... Members>
Member at(const SceneParts& parts) {
    return &((*(parts.*Part)).*....*Members);
}

using P = SceneParts;
using S = SimulationSettings;
using R = RenderSettings;

inline constexpr Limits kNames{1, kLongestName}, kPaths{1, 4096}; // bytes
inline constexpr Limits kNone{0, 0};                              // what has no range: booleans and choices

inline constexpr auto kControllers = ChangedBy::controllers, kOperators = ChangedBy::operators;
inline constexpr auto kNobody = ChangedBy::nobody;

// The same setting with a slider over a part of its range.
constexpr SceneSetting usually(Limits usual, SceneSetting setting) {
    setting.usual = usual;
    return setting;
}

// The same setting, live for controllers in the elements of its list.
constexpr SceneSetting listed(SceneSetting setting) {
    setting.changed_by = kControllers;
    setting.in_list = true;
    return setting;
}

} // namespace brume::setting_rows

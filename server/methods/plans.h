// All medium methods as the plan, commands and people know them: the CPU's half of the table in list.h.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/plan/method_plan.h"

namespace brume {

// Every method, in the order of list.h.
std::span<const MethodPlan* const> methodPlans();
// Null when there is no method of this name.
const MethodPlan* planOf(std::string_view name);

std::vector<std::string> methodNames();
// Of those that draw the scene's medium.
std::vector<std::string> methodNames(const SceneFeatures& features);
// Empty when the settings are valid, whichever of their names a command may change next; otherwise one line: what is
// wrong and what is allowed.
std::string checkSettings(const RenderSettings& settings);

} // namespace brume

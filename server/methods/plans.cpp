#include "server/methods/plans.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/settings.h"

namespace brume {

#define BRUME_METHOD(name)                                                                                             \
    namespace methods::name {                                                                                          \
    const MethodPlan& plan();                                                                                          \
    }
#include "server/methods/list.h"
#undef BRUME_METHOD

std::span<const MethodPlan* const> methodPlans() {
#define BRUME_METHOD(name) &methods::name::plan(),
    static const MethodPlan* const kAll[] = {
#include "server/methods/list.h"
    };
#undef BRUME_METHOD
    return kAll;
}

const MethodPlan* planOf(std::string_view name) {
    for (const MethodPlan* plan : methodPlans())
        if (name == plan->name()) return plan;
    return nullptr;
}

std::vector<std::string> methodNames() {
    std::vector<std::string> names;
    for (const MethodPlan* plan : methodPlans()) names.emplace_back(plan->name());
    return names;
}

std::vector<std::string> methodNames(const SceneFeatures& features) {
    std::vector<std::string> names;
    for (const MethodPlan* plan : methodPlans())
        if (mediumRefusal(*plan, features).empty()) names.emplace_back(plan->name());
    return names;
}

std::string checkSettings(const RenderSettings& settings) {
    if (!planOf(settings.method))
        return fmt::format("no method '{}'; there are: {}", settings.method, fmt::join(methodNames(), ", "));
    RenderSettings render = settings;
    for (const SceneSetting* setting : liveSettings()) {
        const auto& names = setting->choices;
        if (!setting->path.starts_with("render.") || names.empty()) continue;
        const auto chosen = std::get<std::string>(valueOf(*setting, {.render = &render}));
        if (std::find(names.begin(), names.end(), chosen) == names.end())
            return fmt::format("no {} '{}'; there are: {}", setting->key(), chosen, fmt::join(names, ", "));
    }
    for (const MethodPlan* plan : methodPlans())
        if (std::string wrong = plan->refusal(settings); !wrong.empty()) return wrong;
    if (!limits::kMerge.holds(double(settings.merge))) return fmt::format("merge must be 0 ... {}", limits::kMerge.hi);
    return {};
}

} // namespace brume

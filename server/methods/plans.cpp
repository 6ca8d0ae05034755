#include "server/methods/plans.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/scene_limits.h"

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

std::vector<std::string> quadratureNames() {
    std::vector<std::string> names;
    for (const MethodPlan* plan : methodPlans())
        for (const char* name : plan->quadratures())
            if (std::find(names.begin(), names.end(), name) == names.end()) names.emplace_back(name);
    return names;
}

std::string_view quadratureOf(const RenderSettings& settings) {
    const MethodPlan* plan = planOf(settings.method);
    return plan ? plan->quadratureOf(settings) : std::string_view();
}

std::string checkSettings(const RenderSettings& settings) {
    if (!planOf(settings.method))
        return fmt::format("no method '{}'; there are: {}", settings.method, fmt::join(methodNames(), ", "));
    const std::vector<std::string> quadratures = quadratureNames();
    if (std::find(quadratures.begin(), quadratures.end(), settings.quadrature) == quadratures.end())
        return fmt::format("no quadrature '{}'; there are: {}", settings.quadrature, fmt::join(quadratures, ", "));
    for (const MethodPlan* plan : methodPlans())
        if (std::string wrong = plan->refusal(settings); !wrong.empty()) return wrong;
    if (!limits::kMerge.holds(double(settings.merge))) return fmt::format("merge must be 0 ... {}", limits::kMerge.hi);
    return {};
}

} // namespace brume

#include "server/loop/scene_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "server/methods/plans.h"

namespace brume {

std::shared_ptr<SceneReport> sceneReport(const Simulation& simulation, const Plan& plan) {
    auto report = std::make_shared<SceneReport>();
    report->tick = simulation.tick();
    report->state_hash = simulation.stateHash();
    report->particles = simulation.liveCount();
    SceneNow now = simulation.now();
    const Bounds& bounds = simulation.bounds();
    const float reach = 2 * 0.1f * bounds.max_scale * now.medium.falloff; // a deviation is a tenth of scale * falloff
    report->lo = bounds.lo - reach;
    report->hi = bounds.hi + reach;
    for (size_t i = 0; i < report->settings.size(); ++i)
        report->settings[i] = valueOf(*liveSettings()[i], partsOf(now));
    report->settings_version = simulation.settingsVersion();
    report->lists = now.lists;
    report->lists_hash = simulation.listsHash();
    report->undo = simulation.undoText();

    RenderSettings used = plan.chosen.settings;
    auto& told = report->plan;
    told.method = used.method;
    if (const SceneSetting* quadrature = quadratureSetting(used))
        told.quadrature = std::get<std::string>(valueOf(*quadrature, {.render = &used}));
    if (const MethodPlan* method = planOf(used.method)) {
        told.text = method->text(used);
        if (const std::string next = waitsFor(plan); !next.empty())
            told.text += fmt::format(", until the shaders of {} are compiled", next);
        if (method->hasRays()) told.rate = used.rate, told.slabs = used.slabs;
    }
    told.promised = promisedError(now.render);
    told.error = plan.chosen.error, told.ms = plan.chosen.ms(), told.relaxed = plan.relaxed;
    return report;
}

double promisedError(const RenderSettings& wanted) { return wanted.method == kAutoMethod ? double(wanted.error) : 0; }

void tellPaused(SceneReport& report, bool paused, uint64_t changes) {
    const auto all = liveSettings();
    report.settings[size_t(std::ranges::find(all, liveSetting("simulation.paused")) - all.begin())] = paused;
    report.settings_version += changes << 32;
}

} // namespace brume

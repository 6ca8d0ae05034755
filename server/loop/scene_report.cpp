#include "server/loop/scene_report.h"

#include "server/methods/plans.h"

namespace brume {

std::shared_ptr<SceneReport> sceneReport(const Simulation& simulation, const Plan& plan) {
    auto report = std::make_shared<SceneReport>();
    const SceneNow& scene = simulation.now();
    report->tick = simulation.tick();
    report->state_hash = simulation.stateHash();
    report->particles = simulation.liveCount();
    report->paused = scene.simulation.paused;
    report->light = scene.light;
    report->medium = scene.medium;
    report->render = scene.render;
    report->plan = {plan.chosen.settings, plan.chosen.error, plan.chosen.ms(), plan.relaxed};
    RenderSettings& used = report->plan.settings;
    used.quadrature = quadratureOf(used);
    if (const MethodPlan* method = planOf(used.method); !method || !method->hasRays()) used.rate = used.slabs = 0;
    return report;
}

} // namespace brume

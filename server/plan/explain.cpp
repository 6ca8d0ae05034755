#include <fmt/format.h>

#include "server/methods/plans.h"
#include "server/plan/memory.h"
#include "server/plan/plan.h"

namespace brume {
namespace {

std::string row(const std::string& what, const Candidate& c, size_t views, const std::string& why) {
    return fmt::format("  {:<44} {:>8.2f} {:>8.2f} {:>8.3f} {:>7.4f}  {}\n", what, c.shared_ms,
                       c.views_ms / double(views), 100 * c.error, c.flip, why);
}

std::string absent(const SceneFeatures& f) {
    std::string all;
    const auto add = [&](bool there, const char* what) {
        if (!there) all += std::string(all.empty() ? "" : ", ") + what;
    };
    add(f.opaque, "opaque objects");
    add(f.casters, "shadows of objects");
    add(f.lobe, "an anisotropic lobe");
    add(f.ambient, "ambient light");
    return all;
}

} // namespace

std::string wayText(const RenderSettings& settings) { return planOf(settings.method)->text(settings); }

std::string summary(const Plan& plan) {
    const Candidate& c = plan.chosen;
    return fmt::format("{}: {:.3f} % predicted, {:.1f} ms a view, {:.1f} ms shared{}", wayText(c.settings),
                       100 * c.error, c.views_ms / double(plan.views), c.shared_ms,
                       plan.relaxed ? fmt::format(", coarser by {} steps", plan.relaxed) : "");
}

std::string explain(const Plan& plan, const PlanInputs& inputs, const CostModel& model) {
    const RenderSettings &wanted = inputs.scene.wanted, &s = plan.chosen.settings;
    std::string out = fmt::format("costs       {}\n", model.source);
    out += fmt::format("budget      relative RMSE {:.3g} %, FLIP {:.3g}; method {}\n", 100 * wanted.error, wanted.flip,
                       wanted.method);
    out += fmt::format("scene       {} particles, standard deviation {:.3g} m, {} view{}\n", inputs.scene.particles,
                       inputs.scene.extent.deviation, plan.views, plan.views == 1 ? "" : "s");
    const ParticleMemory memory = particleMemory(inputs.scene.particles);
    out += fmt::format("memory      of the particles at most {:.1f} MiB of the CPU's, {:.1f} MiB of the device's\n",
                       double(memory.cpu) / (1 << 20), double(memory.device) / (1 << 20));
    out += fmt::format("plan        {}{}\n", wayText(s),
                       plan.within ? ""
                                   : "; NOT within the budget: nothing is; this is the cheapest of the most accurate");
    for (const PlanScene::Shadow& shadow : inputs.scene.shadows)
        if (shadow.wanted == s.shadow_error)
            out += fmt::format("shadow map  {}x{} texels, {} planes, error {:.3f} %\n", shadow.resolution.texels.x,
                               shadow.resolution.texels.y, shadow.resolution.slices, 100 * shadow.resolution.error);
    if (!plan.refused.empty()) out += fmt::format("refused     {}\n", plan.refused);
    const std::string none = absent(inputs.scene.features);
    if (!none.empty()) out += fmt::format("compiled out  {}\n", none);
    out += fmt::format("\n  {:<44} {:>8}\n", "pass", "ms");
    for (const PassCost& p : plan.passes)
        out += fmt::format("  {:<44} {:>8.3f}  {}\n", p.pass, p.shared ? p.ms : p.ms / double(plan.views),
                           p.shared ? "once per tick" : "a view");
    out += fmt::format("\n  {:<44} {:>8} {:>8} {:>8} {:>7}\n", "way", "shared", "view ms", "error %", "FLIP");
    out += row(wayText(s), plan.chosen, plan.views, "taken");
    for (const Candidate& c : plan.others) out += row(wayText(c.settings), c, plan.views, c.why_not);
    return out;
}

} // namespace brume

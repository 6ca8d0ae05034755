#include <fmt/format.h>

#include "server/effects/propagation/propagation_plan.h"
#include "server/methods/plans.h"
#include "server/plan/memory.h"
#include "server/plan/plan.h"

namespace brume {
namespace {

std::string row(const std::string& what, const Candidate& c, size_t views, const std::string& why) {
    const std::string error =
        c.predicted ? fmt::format("{:>8.3f} {:>7.4f}", 100 * c.error, c.flip) : fmt::format("{:>16}", "not predicted");
    return fmt::format("  {:<66} {:>8.2f} {:>8.2f} {}  {}\n", what, c.shared_ms, c.views_ms / double(views), error,
                       why);
}

std::string errorText(const Candidate& c) {
    return c.predicted ? fmt::format("{:.3f} % predicted", 100 * c.error) : "error not predicted";
}

// What keeps the plan from a cheaper way.
std::string limitText(const Plan& plan, const RenderSettings& wanted) {
    if (!plan.chosen.predicted) return "none: the error of what was asked for is not predicted";
    if (!plan.within) return "error or FLIP: nothing keeps both budgets";
    switch (plan.limit) {
    case Limit::error:
        return fmt::format("error: {:.3f} of {:.3g} %", 100 * plan.chosen.error, 100 * wanted.error);
    case Limit::flip:
        return fmt::format("FLIP: {:.4f} of {:.3g}; its budget, not render.error, keeps the error at {:.3f} %",
                           plan.chosen.flip, wanted.flip, 100 * plan.chosen.error);
    case Limit::both:
        return "error and FLIP: one budget alone would allow nothing cheaper";
    case Limit::time:
        break;
    }
    return "time: of all ways it is the cheapest";
}

std::string viewText(const PlanScene& scene, const PlanView& view) {
    const glm::vec3 eye = view.pose.position, ahead = view.pose.orientation * glm::vec3(0, 0, -1);
    return fmt::format(
        "{}x{}, eye at ({:.3g}, {:.3g}, {:.3g}) looking along ({:.2f}, {:.2f}, {:.2f}), fov_y {:.3g}, {} "
        "the medium",
        view.width, view.height, eye.x, eye.y, eye.z, ahead.x, ahead.y, ahead.z, view.pose.fov_y,
        ViewWork(scene, view).inside() ? "inside" : "outside");
}

std::string absent(const SceneFeatures& f) {
    std::string all;
    const auto add = [&](bool there, const char* what) {
        if (!there) all += std::string(all.empty() ? "" : ", ") + what;
    };
    add(f.opaque, "opaque objects");
    add(f.meshes, "meshes");
    add(f.casters, "shadows of objects");
    add(f.lobe, "an anisotropic lobe");
    add(f.ambient, "ambient light");
    add(f.fog, "fog");
    add(f.glow, "fog that emits light");
    add(f.local_lights, "points and spots");
    add(f.emission, "light that particles emit");
    return all;
}

} // namespace

std::string wayText(const RenderSettings& settings) { return planOf(settings.method)->text(settings); }

std::string waitsFor(const Plan& plan) {
    return plan.within || plan.relaxed > 0 || plan.missing.empty() ? "" : plan.missing.front().method;
}

std::string summary(const Plan& plan) {
    const Candidate& c = plan.chosen;
    return fmt::format("{}: {}, {:.1f} ms a view, {:.1f} ms shared{}", wayText(c.settings), errorText(c),
                       c.views_ms / double(plan.views), c.shared_ms,
                       plan.relaxed ? fmt::format(", coarser by {} steps", plan.relaxed) : "");
}

std::string explain(const Plan& plan, const PlanInputs& inputs, const CostModel& model) {
    const RenderSettings &wanted = inputs.scene.wanted, &s = plan.chosen.settings;
    std::string out = fmt::format("costs       {}\n", model.source);
    out += fmt::format("budget      relative RMSE {:.3g} %, FLIP {:.3g}; method {}\n", 100 * wanted.error, wanted.flip,
                       wanted.method);
    out += fmt::format("scene       {} particles, standard deviation {:.3g} m, {} view{}\n", inputs.scene.particles,
                       inputs.scene.extent.deviation, plan.views, plan.views == 1 ? "" : "s");
    for (const PlanView& view : inputs.views) out += fmt::format("view        {}\n", viewText(inputs.scene, view));
    const ParticleMemory memory = particleMemory(inputs.scene.particles);
    out += fmt::format("memory      of the particles at most {:.1f} MiB of the CPU's, {:.1f} MiB of the device's\n",
                       double(memory.cpu) / (1 << 20), double(memory.device) / (1 << 20));
    if (const uint64_t bytes =
            propagationMemory(inputs.scene.tick, wanted.propagation, inputs.scene.extent.one_albedo, inputs.scene.hues))
        out += fmt::format("memory      of propagation {:.1f} MiB of the device's\n", double(bytes) / (1 << 20));
    const bool outside = !plan.within && plan.chosen.predicted;
    out += fmt::format("plan        {}{}\n", wayText(s),
                       outside ? "; NOT within the budget: nothing is; this is the cheapest of the most accurate" : "");
    out += fmt::format("limit       {}\n", limitText(plan, wanted));
    for (const PlanScene::Shadow& shadow : inputs.scene.shadows)
        if (shadow.wanted == s.shadow_error)
            out += fmt::format("shadow map  {}x{} texels, {} planes, error {:.3f} %\n", shadow.resolution.texels.x,
                               shadow.resolution.texels.y, shadow.resolution.slices, 100 * shadow.resolution.error);
    if (!plan.refused.empty()) out += fmt::format("refused     {}\n", plan.refused);
    const std::string none = absent(inputs.scene.features);
    if (!none.empty()) out += fmt::format("compiled out  {}\n", none);
    out += fmt::format("\n  {:<66} {:>8}\n", "pass", "ms");
    for (const PassCost& p : plan.passes)
        out += fmt::format("  {:<66} {:>8.3f}  {}\n", p.pass, p.shared ? p.ms : p.ms / double(plan.views),
                           p.shared ? "once per tick" : "a view");
    out += fmt::format("\n  {:<66} {:>8} {:>8} {:>8} {:>7}\n", "way", "shared", "view ms", "error %", "FLIP");
    out += row(wayText(s), plan.chosen, plan.views, "taken");
    for (const Candidate& c : plan.others) out += row(wayText(c.settings), c, plan.views, c.why_not);
    return out;
}

} // namespace brume

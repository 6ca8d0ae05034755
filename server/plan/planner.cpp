#include "server/plan/planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/spdlog.h>

#include "common/phase_lobes.h"
#include "server/effects/shadow_volume/shadow_volume_plan.h"
#include "server/inputs/hues.h"
#include "server/inputs/local_light_block.h"
#include "server/inputs/objects.h"
#include "server/inputs/tick_block.h"
#include "server/medium/band_limit.h"
#include "server/plan/alike_views.h"
#include "server/sim/state_hash.h"

namespace brume {
namespace {

constexpr std::chrono::milliseconds kPlanEvery{250}, kLookEvery{1000}, kPatience{2000}, kWaitsUntold{10000};
// A view is far from another if the medium is so many times as large in its picture, or the eye entered or left it.
constexpr double kFar = 2;
// A medium that rests is counted as one that moves once a second: what is done once is cheap, not free.
constexpr double kRenewedAtRest = 1.0 / 60;
constexpr size_t kSample = 256; // particles: an estimate of the work to about a tenth
constexpr size_t kCasters = 64; // boxes and spheres, likewise

// Of what the passes read that run once per tick.
uint64_t stateOf(std::span<const gpu::Particle> particles, const gpu::Tick& tick) {
    static_assert(sizeof(gpu::Particle) % sizeof(float) == 0);
    StateHash state;
    state.add(std::span(reinterpret_cast<const float*>(particles.data()), particles.size_bytes() / sizeof(float)));
    const float others[] = {tick.sun.to_light.x, tick.sun.to_light.y, tick.sun.to_light.z, tick.falloff};
    state.add(others);
    return state.value();
}

void addCasters(std::span<const gpu::Opaque> bodies, PlanScene& out) {
    if (!out.features.casters || bodies.empty()) return;
    const size_t stride = (bodies.size() + kCasters - 1) / kCasters;
    for (size_t i = 0; i < bodies.size(); i += stride)
        out.caster_balls.push_back({bodies[i].centre, meanRadius(bodies[i])});
    out.caster_weight = double(bodies.size()) / double(out.caster_balls.size());
}

} // namespace

PlanView ownView(const Scene& scene) {
    return {lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y), 640, 360};
}

PlanScene planScene(const Scene& scene, const Simulation& simulation, const std::optional<SceneFeatures>& lists) {
    SceneNow now = simulation.now();
    if (lists) leaveOut(now, *lists);
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    const std::vector<gpu::Opaque> objects = opaqueObjects(scene, now.lists);
    PlanScene out;
    out.wanted = now.render;
    out.features = featuresOf(scene, now, lists.value_or(SceneFeatures()));
    out.lobe_width = lobesOf(now.medium).width();
    const uint32_t triangles = uint32_t(scene.triangles.size());
    out.objects = std::min(uint32_t(objects.size()) + triangles, kMostCounted);
    for (const Light& light : now.lists.lights) out.local_lights.push_back(localLightBlock(light));
    out.glasses = scene.glasses;
    std::vector<gpu::Particle> balls;
    ballsOf(particles, simulation.axes(), balls);
    out.tick = makeTick(scene, now, particles, objects, balls);
    addCasters(std::span(objects).subspan(out.tick.plane_count), out);
    out.triangles = out.features.casters ? std::min(triangles, kMostCounted) : 0;
    out.state = stateOf(particles, out.tick);
    out.hues = uint32_t(huesOf(now, simulation.liveCount()).size());
    out.particles = uint32_t(particles.size());
    out.capacity = simulation.capacity();
    out.extent = mediumExtent(particles, out.tick.falloff, out.tick.cut, out.features.tetrahedra);
    if (!balls.empty()) { // laws of errors take each for a ball
        out.extent.deviation = mediumExtent(balls, out.tick.falloff, out.tick.cut).deviation;
        particles = std::move(balls);
    }
    setSmoothLengths(out.local_lights, particles, out.extent, out.tick.falloff, out.features, now.lists.planes);
    const size_t stride = std::max<size_t>((particles.size() + kSample - 1) / kSample, 1);
    for (size_t i = 0; i < particles.size(); i += stride) out.sample.push_back(particles[i]);
    out.medium_sample = MediumSample(out, particles);

    const glm::mat3 basis(out.tick.map.x, out.tick.map.y, out.tick.sun.to_light);
    const ShadowedMedium medium(particles, out.tick.falloff, basis);
    RenderSettings settings = now.render;
    const auto add = [&](float error) {
        settings.shadow_error = error;
        out.shadows.push_back({error, shadowResolution(settings, medium, out.tick.map.hi - out.tick.map.lo)});
    };
    const float most = now.render.shadow_error;
    for (float error = most; error >= kFinestShadow || error == most; error /= 2) add(error);
    for (float error = 2 * most; error <= kCoarsestShadow; error *= 2) add(error);
    return out;
}

Planner::Planner(const Scene& scene, CostModel model, double frame_budget_ms, ReadyWays* ways)
    : scene_(scene), costs_(std::move(model)), ways_(ways), overload_(frame_budget_ms) {
    inputs_.methods = allMethods();
    inputs_.corrections = &corrections_;
    if (ways) inputs_.compiled = [this](const RenderSettings& way) { return ways_->has(way, inputs_.scene.hues > 1); };
}

const RenderSettings& Planner::settings(const Simulation& simulation, std::span<const PlanView> views, bool changed,
                                        Time now) {
    const bool look = changed || looked_ == Time{};
    if (look || someoneJumped(views)) renew(simulation, views, look, false, now);
    return plan_.chosen.settings;
}

void Planner::refresh(const Simulation& simulation, std::span<const PlanView> views, Time now) {
    if (now - planned_ >= kPlanEvery) renew(simulation, views, now - looked_ >= kLookEvery, true, now);
}

// True if one of the views is like none of those that the plan was made for.
bool Planner::someoneJumped(std::span<const PlanView> views) const {
    const MediumExtent& extent = inputs_.scene.extent;
    const auto sameDistance = [&](const PlanView& view, const PlanView& old) {
        if (isInside(extent, view.pose.position) != isInside(extent, old.pose.position)) return false;
        const double now = projectedDeviation(extent, {view.pose, old.width, old.height});
        const double then = projectedDeviation(extent, old);
        return now <= kFar * then && then <= kFar * now;
    };
    return std::ranges::any_of(views, [&](const PlanView& view) {
        return std::ranges::none_of(views_, [&](const PlanView& old) { return sameDistance(view, old); });
    });
}

void Planner::renew(const Simulation& simulation, std::span<const PlanView> views, bool look, bool patient, Time at) {
    if (look) {
        const PlanScene before = std::exchange(inputs_.scene, planScene(scene_, simulation, lists_));
        if (simulation.tick() == looked_tick_) {
            inputs_.scene.renewed = before.renewed;
        } else if (looked_ != Time{} && inputs_.scene.state == before.state) {
            inputs_.scene.renewed = kRenewedAtRest;
        }
        looked_ = at;
        looked_tick_ = simulation.tick();
    }
    views_.assign(views.begin(), views.end());
    inputs_.views = alikeViews(views, inputs_.scene.extent, corrections_);
    inputs_.pictures = views.size();
    planned_ = at;
    if (!plan_.by_patience) patient_since_ = at;
    inputs_.patient = patient && at - patient_since_ < kPatience;
    make();
}

void Planner::make() {
    const RenderSettings then = plan_.chosen.settings;
    const bool first = plan_.passes.empty();
    inputs_.relaxed = overload_.level();
    inputs_.relaxed_before = plan_.relaxed;
    plan_ = makePlan(inputs_, costs_.model());
    if (inputs_.compiled) waitForShaders();
    inputs_.before = plan_.base;
    inputs_.before_deviation_px = plan_.reference_deviation_px;
    for (const RenderSettings& way : plan_.missing) {
        if (!ways_) break;
        ways_->want(way, false); // also where its pictures have several hues: its pixels are read back then
        if (inputs_.scene.hues > 1) ways_->want(way, true);
    }
    const RenderSettings& now = plan_.chosen.settings;
    if (ways_) ways_->use(now, inputs_.scene.hues > 1);
    if (first || now.method != then.method || now.rate != then.rate || now.slabs != then.slabs)
        spdlog::debug("plan: {}", summary(plan_));
    tellWaiting();
    const std::string& wanted = inputs_.scene.wanted.method;
    if (!plan_.refused.empty() && wanted != kAutoMethod && now.method != wanted && (first || now.method != then.method))
        spdlog::warn("refused: {}; instead: {}", plan_.refused, summary(plan_));
}

// A new scene's first seconds are nobody's concern.
void Planner::tellWaiting() {
    const std::string waits_for = waitsFor(plan_);
    if (waits_for.empty()) {
        if (std::exchange(waits_told_, false)) spdlog::info("shaders are compiled; pictures: {}", summary(plan_));
        waits_since_.reset();
    } else if (!waits_since_) {
        waits_since_ = planned_;
    } else if (planned_ - *waits_since_ > kWaitsUntold && !std::exchange(waits_told_, true)) {
        spdlog::warn("shaders of {} are still being compiled; pictures until then: {}", waits_for, summary(plan_));
    }
}

// The settings that there was last a compiled way for, but what no shader depends on. Precondition: there was one.
RenderSettings Planner::asDrawn(const RenderSettings& asked) const {
    RenderSettings drawn = *drawn_for_;
    drawn.exposure = asked.exposure;
    return drawn;
}

// Pictures are made as they were until something is compiled for what is asked for now.
void Planner::waitForShaders() {
    const auto drawable = [&](const Plan& plan) {
        RenderSettings way = plan.chosen.settings;
        if (plan.reference_deviation_px > 0) way.rate = nearestCompiledRate(way, inputs_.compiled);
        return inputs_.compiled(way);
    };
    const RenderSettings asked = inputs_.scene.wanted;
    if (!drawn_for_ || drawable(plan_)) {
        drawn_for_ = asked; // the first is compiled where it is drawn
    } else {
        inputs_.scene.wanted = asDrawn(asked);
        Plan old = makePlan(inputs_, costs_.model());
        inputs_.scene.wanted = asked;
        if (!drawable(old)) return;
        old.missing = std::move(plan_.missing);
        old.refused = std::move(plan_.refused);
        plan_ = std::move(old);
    }
}

Candidate Planner::once(const Simulation& simulation, const PlanView& view, bool compiled) const {
    PlanInputs alone{.scene = planScene(scene_, simulation, lists_), .views = {view}, .methods = inputs_.methods};
    alone.law_factor = inputs_.law_factor;
    if (compiled && ways_) alone.compiled = [this](const RenderSettings& way) { return ways_->has(way, true); };
    Candidate way = makePlan(alone, costs_.first()).chosen;
    if (!alone.compiled || alone.compiled(way.settings) || !drawn_for_) return way;
    alone.scene.wanted = asDrawn(alone.scene.wanted);
    Candidate old = makePlan(alone, costs_.first()).chosen;
    return alone.compiled(old.settings) ? old : way;
}

uint32_t Planner::rateOf(const PlanView& view, const RenderSettings& settings, bool still) const {
    const double reference = plan_.reference_deviation_px;
    if (reference <= 0) return 0;
    RenderSettings own = settings;
    own.rate = rateFor(settings.rate, projectedDeviation(inputs_.scene.extent, view) / reference);
    const bool full = still || inputs_.scene.hues > 1;
    if (!ways_) return own.rate;
    if (!ways_->has(own, full)) {
        ways_->want(own, full);
        own.rate = nearestCompiledRate(own, [&](const RenderSettings& way) { return ways_->has(way, full); });
    }
    ways_->use(own, full);
    return own.rate;
}

bool Planner::drawable(const RenderSettings& settings, bool still) const {
    const bool full = still || inputs_.scene.hues > 1;
    if (!ways_) return true;
    if (ways_->has(settings, full)) {
        ways_->use(settings, full);
        return true;
    }
    ways_->want(settings, full);
    return false;
}

void Planner::passesTook(const RenderSettings& settings, std::span<const PlanView> views,
                         std::span<const uint32_t> rates, std::span<const PassMs> passes, bool disturbed) {
    Work work = sharedWork(inputs_.scene, settings);
    for (const PlanScene::Shadow& shadow : inputs_.scene.shadows)
        if (shadow.wanted == settings.shadow_error) work += shadowWork(inputs_.scene, shadow);
    for (size_t i = 0; i < views.size(); ++i) {
        RenderSettings own = settings;
        if (rates[i] > 0) own.rate = rates[i];
        const ViewWork view(inputs_.scene, views[i]);
        if (view.sees() || hasExtras(inputs_.scene.features)) work += view.of(own);
    }
    costs_.learn(work, passes, disturbed);
}

void Planner::took(double ms, Time now) {
    const double restored = plan_.relaxed > 0 ? plan_.less_relaxed_ms / plan_.chosen.ms() : 1;
    const uint32_t before = overload_.level();
    if (!overload_.took(ms, restored, now)) return;
    make();
    if (plan_.relaxed < overload_.level()) { // nothing is left to give up
        overload_.stepBack();
        if (!std::exchange(exhausted_, true))
            spdlog::warn("frames take too long ({:.1f} ms) with no accuracy left to give up: {}", ms, summary(plan_));
        return;
    }
    exhausted_ = false;
    const uint32_t level = overload_.level();
    worst_ = std::max(worst_, level);
    if (before == 0) {
        overloaded_since_ = now;
        spdlog::warn("frames take too long ({:.1f} ms): accuracy is given up, step by step; first {}", ms,
                     summary(plan_));
    } else if (level == 0) {
        const auto lasted = std::chrono::duration_cast<std::chrono::seconds>(now - overloaded_since_);
        spdlog::warn("accuracy is back after {} s, at worst coarser by {} steps: {}", lasted.count(),
                     std::exchange(worst_, 0), summary(plan_));
    } else {
        spdlog::debug("{} ({:.1f} ms): {}", level > before ? "frames take too long" : "frames are short enough again",
                      ms, summary(plan_));
    }
}

} // namespace brume

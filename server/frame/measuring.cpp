// What the frame loop learns while it runs: the error of its pictures, of which it has some pixels read back for the
// meter, and what passes cost.
#include <algorithm>
#include <cmath>
#include <new>

#include <spdlog/spdlog.h>

#include "server/frame/frame_loop.h"
#include "server/loop/scene_report.h"

namespace brume {
namespace {

constexpr auto kLearnEvery = std::chrono::milliseconds(250);
constexpr std::chrono::seconds kFirstTold{10}, kToldEvery{600};

// The box of what is seen of the particles: a Gaussian beyond 3.5 / k has lost all but 1e-5 of its extinction.
void boundsOf(std::span<const gpu::Particle> particles, float falloff, glm::vec3& lo, glm::vec3& hi) {
    lo = glm::vec3(1e30f), hi = glm::vec3(-1e30f);
    for (const gpu::Particle& p : particles) {
        const float reach = 3.5f * p.scale * falloff / 7.0710678f;
        lo = glm::min(lo, p.centre - reach), hi = glm::max(hi, p.centre + reach);
    }
}

} // namespace

Measuring::Measuring(const ShownScene& shown, const gpu::Device& device, const FrameOptions& options)
    : shown_(shown), device_(device), meter_(options.measure_error), learns_costs_(options.learn_costs),
      on_costs_(options.on_costs), on_errors_(options.on_errors) {}

void Measuring::before(Batch& batch, const Planner& planner, const CompiledWays& ways) {
    choose(batch, planner, ways);
    show(batch);
    tell(batch);
}

void Measuring::choose(Batch& batch, const Planner& planner, const CompiledWays& ways) {
    const RenderSettings& settings = batch.settings;
    ProbeReading& probe = batch.submission.probe;
    probe.pixels.clear();
    if (!meter_.measures() || settings.scattering != "single") {
        for (const BatchJob& job : batch.jobs) job.viewer->cannotMeasure();
        return;
    }
    drawn_viewers_.clear();
    for (const BatchJob& job : batch.jobs)
        if (batch.isDrawnFor(job)) drawn_viewers_.push_back(job.viewer->id());
    std::unique_ptr<MeterJob> job = meter_.begin(drawn_viewers_, batch.taken);
    if (!job) return;
    const auto of = std::ranges::find(batch.jobs, job->viewer, [](const BatchJob& one) { return one.viewer->id(); });
    const EyeRequest& eye = batch.eyes[of->first_eye];
    job->with = drawnWith(settings, eye);
    if (!ways.mayProbe(job->with.settings)) return meter_.drop(std::move(job));
    job->law = planner.predictedError(job->with.settings, {eye.pose, eye.width, eye.height});
    job->keeps = eye.show == gpu::kShowError;
    job->lit.reset();
    if (!fill(*job, eye.pose, {eye.width, eye.height}))
        for (const BatchJob& one : batch.jobs)
            if (one.pictures == of->pictures) one.viewer->cannotMeasure();
    if (job->pixels.empty()) return meter_.drop(std::move(job));
    probe.eye = of->first_eye;
    probe.pixels = job->pixels;
    batch.measured = std::move(job);
}

// The scene as it is now, and pixels of a picture. False: none shows the medium.
bool Measuring::fill(MeterJob& job, const Pose& pose, glm::uvec2 size) const {
    const Simulation& simulation = shown_.simulation;
    job.scene = shown_.scene;
    job.now = simulation.now();
    leaveOut(job.now, shown_.drawn);
    job.pose = pose;
    job.size = size;
    job.pixels.clear();
    try {
        job.particles.resize(simulation.liveCount());
        simulation.write(job.particles);
        job.axes.assign(simulation.axes().begin(), simulation.axes().end());
        glm::vec3 lo = pose.position - 1.0f, hi = lo + 2.0f; // around the eye: with fog any pixel may show it
        const bool fog = std::ranges::any_of(job.now.lists.fogs, isThere);
        if (!fog) boundsOf(job.particles, job.now.medium.falloff, lo, hi);
        if (fog || !job.particles.empty()) job.pixels = pixelsOf(pose, size, lo, hi, job.number);
        return !job.pixels.empty();
    } catch (const std::bad_alloc&) { // where memory is short nothing is measured, and the picture is drawn
        return true;
    }
}

std::unique_ptr<MeterJob> Measuring::beginLit(std::span<const Drawer> drawers, Clock::time_point now) {
    if (!meter_.measures() || shown_.simulation.now().render.scattering != "single") return nullptr;
    drawn_viewers_.clear();
    for (const Drawer& one : drawers) drawn_viewers_.push_back(one.viewer);
    std::unique_ptr<MeterJob> job = meter_.begin(drawn_viewers_, now);
    if (!job) return nullptr;
    const PoseRequest& request = *std::ranges::find(drawers, job->viewer, &Drawer::viewer)->request;
    job->with = {shown_.simulation.now().render, shown_.simulation.settingsVersion()};
    job->with.settings.method = kDrawnByViewer;
    job->law = 0;
    job->drawn = job->keeps = false;
    fill(*job, eyePose(request.pose, 0, request.views), {request.width, request.height});
    if (!job->pixels.empty()) return job;
    meter_.drop(std::move(job));
    return nullptr;
}

void Measuring::giveLit(std::unique_ptr<MeterJob> job, std::shared_ptr<const lit::Medium> medium) {
    if (!medium) return meter_.drop(std::move(job));
    job->lit = std::move(medium);
    meter_.give(std::move(job));
}

MeasuredError Measuring::known(uint32_t viewer, const std::string& method) const {
    const auto found = std::ranges::find_if(errors_, [&](const ViewError& one) {
        return one.viewer == viewer && one.method == method && one.error.known();
    });
    if (found == errors_.end()) return {};
    return {float(found->error.rmse), float(found->error.low), float(found->error.high)};
}

float Measuring::knownOfDrawers() const {
    double squares = 0, count = 0;
    for (const ViewError& one : errors_)
        if (one.method == kDrawnByViewer && one.error.known()) squares += one.error.rmse * one.error.rmse, ++count;
    return count > 0 ? float(std::sqrt(squares / count)) : 0;
}

DrawnWith Measuring::drawnWith(const RenderSettings& settings, const EyeRequest& eye) const {
    DrawnWith with{settings, shown_.simulation.settingsVersion()};
    if (eye.rate > 0) with.settings.rate = eye.rate;
    return with;
}

// Those who look at their error see the pixels that were measured since their camera rests, of pictures like this one.
void Measuring::show(Batch& batch) {
    shown_errors_.clear();
    const auto each = [&](const auto& visit) { // a job's pictures; the right eye's are not measured
        for (const BatchJob& job : batch.jobs)
            if (batch.isDrawnFor(job) && job.due.request.show == gpu::kShowError) visit(job, batch.eyes[job.first_eye]);
    };
    std::vector<size_t> counts;
    each([&](const BatchJob& job, const EyeRequest& eye) {
        const size_t before = shown_errors_.size();
        meter_.shown(job.viewer->id(), eye.pose, drawnWith(batch.settings, eye), batch.taken, shown_errors_);
        counts.push_back(shown_errors_.size() - before);
    });
    size_t at = 0, n = 0;
    each([&](const BatchJob&, EyeRequest& eye) {
        eye.errors = std::span(shown_errors_).subspan(at, counts[n]);
        at += counts[n++];
    });
}

void Measuring::after(Batch& batch, bool drawn) {
    if (!batch.measured) return;
    ProbeReading& probe = batch.submission.probe;
    if (!drawn) return meter_.drop(std::move(batch.measured));
    const std::span<const glm::vec4> values = probe.values();
    batch.measured->values.assign(values.begin(), values.end());
    batch.measured->drawn = probe.drawn;
    meter_.give(std::move(batch.measured));
}

// The pictures of a viewer who shares them are measured as those of the one who draws them.
void Measuring::tell(Batch& batch) const {
    for (BatchJob& job : batch.jobs) {
        const uint32_t viewer = batch.jobs[job.pictures].viewer->id();
        if (const MeasuredError error = known(viewer, batch.settings.method); error.rmse > 0) job.measured = error;
    }
}

void Measuring::read(std::span<const uint32_t> viewers, Planner& planner, Clock::time_point now) {
    meter_.stay(viewers);
    errors_ = meter_.errors(now);
    Corrections& corrections = planner.corrections();
    for (const ViewError& one : errors_) {
        const ErrorEstimate& e = one.newest;
        if (!e.known() || e.law <= 0) continue;
        corrections.learn(one.viewer, one.method, e.law, {e.rmse / e.law, e.low / e.law, e.high / e.law}, now);
    }
    corrections.fade(now);
    const Plan& plan = planner.plan();
    const double promised = promisedError(shown_.simulation.now().render);
    const auto line = promise_.look({promised, worstOf(errors_, plan.chosen.settings.method), plan.relaxed > 0}, now);
    if (on_errors_) on_errors_(shown_.simulation.tick(), errors_, plan);
    if (line) spdlog::log(line->broken ? spdlog::level::warn : spdlog::level::info, line->text);
}

void Measuring::forget() {
    meter_.forget();
    errors_.clear();
    promise_ = {};
}

void Measuring::learnCosts(const Batch& batch, std::span<const gpu::PassSample> samples, Planner& planner) {
    if (!learns_costs_ || batch.one_shot || batch.done - costs_learnt_ < kLearnEvery) return;
    if (costs_learnt_ == Clock::time_point{}) costs_told_ = batch.done - kToldEvery + kFirstTold;
    costs_learnt_ = batch.done;
    const bool disturbed = other_work_.disturbs() && device_.isCpu();
    std::vector<PlanView> views;
    std::vector<uint32_t> rates;
    for (const EyeRequest& eye : batch.eyes) {
        views.push_back({eye.pose, eye.width, eye.height});
        rates.push_back(eye.rate);
    }
    std::vector<PassMs> passes;
    for (const gpu::PassSample& sample : samples) passes.push_back({sample.name, double(sample.ms)});
    planner.passesTook(batch.settings, views, rates, passes, disturbed);
    if (!on_costs_ || !planner.costs().isKnown() || batch.done - costs_told_ < kToldEvery) return;
    costs_told_ = batch.done;
    on_costs_(planner.costs().model());
}

} // namespace brume

#include "tools/bench/correction.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include "server/frame/frame_loop.h"
#include "server/loop/scene_report.h"
#include "tools/bench/looker.h"

namespace brume::bench {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr auto kEvery = std::chrono::milliseconds(500); // from one sample to the next
constexpr std::chrono::seconds kPatience{60};           // until something is measured
constexpr float kTurn = 0.02f;                          // rad/s, that the viewer flies
constexpr double kFrameMs = 1000; // budget of a frame: accuracy that overload takes is another matter

// Samples of a running loop, taken on its thread.
class Samples {
public:
    void take(std::span<const ViewError> errors, const Plan& plan) {
        const Clock::time_point now = Clock::now();
        const RenderSettings& settings = plan.chosen.settings;
        const auto found = std::ranges::find(errors, settings.method, &ViewError::method);
        const ErrorEstimate known = found != errors.end() && found->newest.known() ? found->newest : ErrorEstimate{};
        const std::scoped_lock lock(mutex_);
        if (!first_ && known.known()) first_ = now;
        if (!first_ || (!all_.empty() && now - last_ < kEvery)) return;
        last_ = now;
        all_.push_back({Seconds(now - *first_).count(), wayText(settings), double(settings.rate),
                        double(settings.slabs), plan.chosen.error, known});
    }
    // Nothing is measured before.
    std::optional<Clock::time_point> first() const {
        const std::scoped_lock lock(mutex_);
        return first_;
    }
    std::vector<CorrectionSample> all() const {
        const std::scoped_lock lock(mutex_);
        return all_;
    }

private:
    mutable std::mutex mutex_;
    std::optional<Clock::time_point> first_;
    Clock::time_point last_{};
    std::vector<CorrectionSample> all_;
};

} // namespace

CorrectionRun correctionRun(const gpu::Device& device, const CostModel& costs, const CorrectionQuestion& question) {
    const Scene scene = sceneOf(question.wanted);
    CorrectionRun run{.promised = promisedError(scene.render)};
    if (run.promised <= 0)
        throw SceneError("nothing is promised where the scene names the method: leave render.method to auto");
    const Pose pose = poseOf(question.wanted.camera, scene, Simulation(scene));

    Audience audience({device.name(), {}}, sceneFacts(scene), 1, 4);
    Metrics metrics;
    Samples samples;
    FrameLoop::Options options;
    options.frame_ms = options.most_frame_ms = kFrameMs;
    options.measure_error = question.measure_error;
    options.costs = costs;
    options.on_errors = [&](uint64_t, std::span<const ViewError> errors, const Plan& plan) {
        samples.take(errors, plan);
    };
    FrameLoop loop(scene, device, audience, metrics, options);
    loop.start([] {});
    Looker looker(audience, uint16_t(question.wanted.size.x), uint16_t(question.wanted.size.y));
    const Clock::time_point began = Clock::now();
    bool broken = false;
    for (uint32_t seq = 1;; ++seq) {
        const Clock::time_point now = Clock::now();
        const std::optional<Clock::time_point> first = samples.first();
        if (!first && now - began > kPatience)
            throw std::runtime_error("nothing was measured in a minute: does the camera see the medium?");
        const double s = first ? Seconds(now - *first).count() : 0;
        run.samples = samples.all();
        if (s >= question.seconds || (broken && question.done && question.done(run))) break;
        if (!broken && s >= question.at) {
            loop.setLawFactor(question.law_factor);
            [[maybe_unused]] const bool taken =
                audience.commands().push({0, 0, Set{{"render.exposure", scene.render.exposure}}});
            run.broken_s = s;
            broken = true;
        }
        looker.look(seq, turnedAbout(pose, scene.camera.target, kTurn * Seconds(now - began).count()));
        if (!looker.next()) {
            loop.stop();
            if (loop.failure()) std::rethrow_exception(loop.failure());
            throw std::runtime_error(looker.refusal().empty() ? "no frame came for half a minute" : looker.refusal());
        }
        ++run.frames;
    }
    loop.stop();
    if (loop.failure()) std::rethrow_exception(loop.failure());
    return run;
}

CorrectionTimes timesOf(const CorrectionRun& run) {
    CorrectionTimes out;
    for (const CorrectionSample& one : run.samples) {
        if (!one.measured.known()) continue;
        if (one.s < run.broken_s) {
            out.before = &one;
            continue;
        }
        // Nothing is known of the new pictures yet.
        if (out.before && one.measured == out.before->measured) continue;
        out.last = &one;
        if (!out.worst || one.measured.rmse > out.worst->measured.rmse) out.worst = &one;
        const bool above = one.measured.rmse > run.promised;
        if (!out.above && above) out.above = &one;
        if (out.above && !out.within && !above) out.within = &one;
        if (!out.within) continue;
        ++out.after;
        out.after_above += above;
    }
    return out;
}

} // namespace brume::bench

#include "server/frame/frame_loop.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "server/loop/asks.h"
#include "server/plan/memory.h"
#include "server/sim/point_cloud.h"

namespace brume {
namespace {

constexpr auto kReportEvery = std::chrono::seconds(1);
constexpr auto kLoadEvery = std::chrono::milliseconds(100);
constexpr auto kLongestLook = std::chrono::milliseconds(100); // at ticks, before other things are seen to

using Millis = std::chrono::duration<float, std::milli>;

ShownScene shownScene(const Scene& scene, const FrameOptions& options) {
    ShownScene shown{std::make_shared<const Scene>(scene), Simulation(scene, options.memory)};
    shown.drawn = featuresOf(shown.simulation.now());
    shown.simulation.countFrom(options.first_tick);
    tellOfPointCloud(scene, shown.simulation);
    return shown;
}

} // namespace

FrameLoop::FrameLoop(const Scene& scene, const gpu::Device& device, Audience& audience, Metrics& metrics,
                     const Options& options)
    : audience_(audience), metrics_(metrics), ticked_(options.ticked), memory_(options.memory),
      frame_ms_(options.frame_ms), law_factor_(options.law_factor), shown_(shownScene(scene, options)),
      drawing_(shown_, device, audience, metrics, options) {
    report(Clock::now()); // viewers who come before the first tick are told the scene's own settings
    if (options.turns)
        seat_.emplace(*options.turns, [this] {
            const std::scoped_lock lock(mutex_);
            turn_ = true;
            wake_.notify_all();
        });
}

FrameLoop::~FrameLoop() { stop(); }

void FrameLoop::start(std::function<void()> on_failure, std::unique_ptr<TickSource> ticks) {
    ticks_ = ticks ? std::move(ticks) : std::make_unique<LocalTicks>(audience_.commands(), Clock::now());
    thread_ = std::thread([this, on_failure = std::move(on_failure)] {
        try {
            run();
        } catch (...) {
            failure_ = std::current_exception();
            audience_.ready = false;
            on_failure();
        }
    });
}

void FrameLoop::stop() {
    {
        const std::scoped_lock lock(mutex_);
        stopping_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
}

// tick    commands -> Simulation::step                                                once
// batch   Drawing: due viewers -> BatchPlanner -> Planning -> Renderer::submit        once for all viewers in it
// frame   Encoding: planes -> encodePictures -> Viewer::deliver                       per viewer, on its threads
void FrameLoop::run() {
    if (const auto beginning = ticks_->beginning())
        goOnFrom(*beginning);
    else if (ticked_)
        ticked_(shown_.simulation, {}, false);
    audience_.ready = told_.serves = ticks_->serves();
    for (;;) {
        // Wait for the next tick, or for the device if that is earlier.
        const Clock::time_point asleep = Clock::now();
        const Clock::time_point due = ticks_->due();
        const auto until_tick =
            due <= asleep ? Clock::duration::zero() : std::min<Clock::duration>(due - asleep, kReportEvery);
        if (drawing_.isBusy()) {
            drawing_.wait(until_tick);
            const std::scoped_lock lock(mutex_);
            if (stopping_ && !drawing_.isBusy()) return;
        } else {
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, until_tick, [&] { return stopping_ || turn_; });
            if (stopping_) return;
            turn_ = false;
        }

        if (!drawing_.isBusy()) takeScene();
        const Clock::time_point now = Clock::now();
        if (!drawing_.isBusy()) drawing_.giveBack(now);
        if (const auto beginning = ticks_->beginning()) goOnFrom(*beginning);
        const bool sought = ticks_->seeks();
        while (ticks_->take(now, commands_)) {
            tick();
            if (Clock::now() - now > kLongestLook) break; // many ticks of a seek: the rest comes with the next look
        }
        giveParticles();
        pointing_.follow(*shown_.scene, shown_.simulation, audience_.people());
        followTicks(sought);
        followLists();
        if (!drawing_.isBusy() && !ticks_->seeks() && (drawing_.isDue() || ticks_->stands()) && mayDraw())
            drawing_.draw();
        if (seat_ && !drawing_.isBusy()) seat_->give(Clock::now()); // nothing was due
        if (now - told_.load_at >= kLoadEvery) {
            told_.load_at = now;
            drawing_.tellLoad(now);
        }
        if (told_.stale || now - told_.at >= kReportEvery) report(now);
    }
}

// A scene that nobody looks at does not ask for the device that others share.
bool FrameLoop::mayDraw() {
    if (!seat_) return true;
    const uint32_t watchers = audience_.size();
    return watchers > 0 && seat_->take(watchers, Clock::now());
}

void FrameLoop::tick() {
    const Clock::time_point begin = Clock::now();
    Simulation& simulation = shown_.simulation;
    const bool empty = simulation.liveCount() == 0;
    if (!commands_.empty()) drawing_.pace().disturb(begin);
    simulation.step(commands_);
    for (const Command& command : commands_) {
        const Asks asks = asksFor(command.body);
        if (asks == Asks::nothing) continue;
        told_.stale = true;
        drawing_.planning().commandsCame();
        if (asks == Asks::at_once) drawing_.planning().renew();
    }
    if (empty != (simulation.liveCount() == 0)) {
        told_.stale = true;
        drawing_.planning().renew();
    }
    if (!commands_.empty() || !simulation.now().simulation.paused) ++shown_.version;
    if (!simulation.refused().empty()) tellRefused();
    metrics_.ticked(Millis(Clock::now() - begin).count());
    for (const Command& command : commands_)
        if (command.received != Clock::time_point()) metrics_.commandTaken(Millis(begin - command.received).count());
    drawing_.setBudget(frame_ms_ * (seat_ ? seat_->part(begin) : 1), law_factor_);
    if (ticked_) ticked_(simulation, commands_, true);
}

// Those who asked for what cannot be are told. The report comes first, so that who was refused and asks for the scene
// is given the state that refused it. A picture, which may take long, comes between a tick and its report otherwise.
void FrameLoop::tellRefused() {
    report(Clock::now());
    told_.stale = true; // the plan of the next picture
    audience_.list(viewers_);
    for (const RefusedCommand& refused : shown_.simulation.refused())
        for (const auto& viewer : viewers_)
            if (viewer->id() == refused.viewer) viewer->refuseInput({refused.seq, refused.why});
    viewers_.clear();
}

// Viewers are told of what is new about ticks besides their number. `sought`: TickSource::seeks() before the last ones.
void FrameLoop::followTicks(bool sought) {
    if (told_.paused != ticks_->paused() || sought != ticks_->seeks() || told_.standstill != ticks_->standstill())
        told_.stale = true;
    if (told_.serves != ticks_->serves()) audience_.ready = told_.serves = !told_.serves;
}

// Pictures at rest are drawn anew, by a new plan, and viewers are told.
void FrameLoop::changed() {
    ++shown_.version;
    drawing_.pace().disturb(Clock::now());
    told_.stale = true;
    drawing_.planning().renew();
}

// Pictures show what commands made of the scene's lists once shaders for it are compiled, and what there was until
// then. The simulation waits for nothing.
void FrameLoop::followLists() {
    const SceneFeatures now = featuresOf(shown_.simulation.now());
    if (!drawing_.ways().follow(now) || now == shown_.drawn) return;
    shown_.drawn = now;
    drawing_.planning().planner().drawOnly(now);
    changed();
}

// Goes on from another state of the same scene.
void FrameLoop::goOnFrom(std::span<const std::byte> state) {
    shown_.simulation.load(state);
    changed();
    if (ticked_) ticked_(shown_.simulation, {}, false);
}

std::future<void> FrameLoop::replaceScene(NextScene next) {
    const std::scoped_lock lock(mutex_);
    next_.emplace(std::move(next));
    next_is_shown_ = {};
    return next_is_shown_.get_future();
}

void FrameLoop::giveParticles() {
    const Simulation& simulation = shown_.simulation;
    while (const auto request = audience_.particleRequests().take()) {
        TakenParticles taken{.scene = shown_.scene->name,
                             .tick = simulation.tick(),
                             .state_hash = simulation.stateHash(),
                             .first = simulation.firstId(),
                             .origin = shown_.scene->origin,
                             .falloff = simulation.now().medium.falloff,
                             .particles = {}};
        if (!shown_.scene->volume) { // its particles stand for voxels
            taken.particles.resize(simulation.liveCount());
            simulation.write(taken.particles);
        }
        taken.axes.assign(simulation.axes().begin(), simulation.axes().end());
        request->answer(std::move(taken));
    }
}

// Shows the scene that waits, if there is one. Nothing of the old one is on the device.
void FrameLoop::takeScene() {
    std::optional<NextScene> next;
    std::promise<void> shown;
    {
        const std::scoped_lock lock(mutex_);
        if (!next_) return;
        next = std::exchange(next_, std::nullopt);
        shown = std::exchange(next_is_shown_, {});
    }
    std::shared_ptr<const SceneFacts> facts;
    try {
        drawing_.prepare(next->scene, boundedCapacity(next->scene, next->simulation, memory_));
        facts = sceneFacts(next->scene, std::move(next->others));
        next->simulation.countFrom(shown_.simulation.tick() + 1); // a tick has one state
        if (next->on_show) next->on_show(next->simulation);
    } catch (const gpu::DeviceLost&) {
        throw;
    } catch (const std::exception&) { // also std::bad_alloc: the old scene is shown again
        const std::exception_ptr reason = std::current_exception();
        next.reset(); // its particles' memory may be what the old scene lacks
        drawing_.prepare(*shown_.scene, shown_.simulation.capacity());
        return shown.set_exception(reason);
    }
    shown_.scene = std::make_shared<const Scene>(std::move(next->scene));
    shown_.simulation = std::move(next->simulation);
    shown_.drawn = featuresOf(shown_.simulation.now());
    ++shown_.version;
    drawing_.pace().disturb(Clock::now());
    pointing_.forget();
    drawing_.showScene();
    audience_.setScene(std::move(facts));
    audience_.prepare({}); // it is there
    report(Clock::now());
    shown.set_value();
}

void FrameLoop::report(Clock::time_point now) {
    told_.at = now;
    told_.stale = false;
    const std::shared_ptr<SceneReport> report = sceneReport(shown_.simulation, drawing_.planning().planner().plan());
    if (ticks_) {
        if (told_.paused != ticks_->paused()) ++told_.pauses;
        told_.paused = ticks_->paused();
        if (told_.paused) tellPaused(*report, *told_.paused, told_.pauses);
        told_.standstill = ticks_->standstill();
        if (told_.standstill) report->standstill = told_.standstill;
    }
    report->not_drawable = whyNotDrawable(shown_);
    report->preparing = audience_.preparing();
    drawing_.report(*report);
    audience_.publish(report);
}

} // namespace brume

// The scene that the frame loop shows: the first one, and those that replace it while it runs.
#include <algorithm>
#include <condition_variable>
#include <stop_token>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>

#include "common/cores.h"
#include "server/frame.h"
#include "server/plan/memory.h"
#include "server/sim/point_cloud.h"
#include "server/warm_up.h"

namespace brume {
namespace {

// Threads that encode: one for each core, in these bounds.
constexpr unsigned kLeastEncoders = 2, kMostEncoders = 16;
constexpr auto kLongStart = std::chrono::seconds(1), kTellAgain = std::chrono::seconds(5);
constexpr std::chrono::milliseconds kKnown{700}; // within which shaders are drawn with that are compiled already

// Says in the log that shaders are being compiled, and for how long, while it lives.
class Progress {
public:
    Progress()
        : thread_([this](const std::stop_token& over) {
              const Clock::time_point begun = Clock::now();
              const auto isOverAfter = [&](Clock::duration time) {
                  std::unique_lock lock(mutex_);
                  return woken_.wait_for(lock, over, time, [&] { return over.stop_requested(); });
              };
              if (isOverAfter(kLongStart)) return;
              spdlog::info("compiling shaders, which takes half a minute: a driver does so once, and then has them in "
                           "its cache");
              while (!isOverAfter(kTellAgain))
                  spdlog::info("still compiling shaders, for {:.0f} s",
                               std::chrono::duration<double>(Clock::now() - begun).count());
          }) {}

private:
    std::mutex mutex_;
    std::condition_variable_any woken_;
    std::jthread thread_; // the last member: it uses the others
};

} // namespace

FrameLoop::FrameLoop(const Scene& scene, const gpu::Device& device, Audience& audience, Metrics& metrics,
                     const Options& options)
    : device_(device), audience_(audience), metrics_(metrics), scene_(scene), ticked_(options.ticked),
      costs_(options.costs), memory_(options.memory), picture_memory_(options.picture_memory),
      frame_ms_(options.frame_ms), law_factor_(options.law_factor), most_frame_ms_(options.most_frame_ms),
      pipelines_(device.pipelines(), [this](const std::string& text) { pipelineMade(text); }),
      simulation_(scene, options.memory),
      renderer_(std::in_place, device, scene, boundedCapacity(scene, simulation_, options.memory)),
      planner_(std::in_place, scene_, options.costs, options.frame_ms, &ways_), refinement_(options.refine_moving),
      meter_(options.measure_error), learns_costs_(options.learn_costs), on_costs_(options.on_costs),
      on_errors_(options.on_errors), shown_scene_(std::make_shared<const Scene>(scene)),
      workers_(std::clamp(usableCores(), kLeastEncoders, kMostEncoders)) {
    ways_.setAll(!options.compiled_behind);
    drawn_ = featuresOf(simulation_.now());
    ways_.clear(drawn_);
    simulation_.countFrom(options.first_tick);
    tellOfPointCloud(scene_, simulation_);
    for (unsigned i = 0; i < std::max(options.batches, 2u); ++i) batches_.push_back(std::make_unique<Batch>(device));
    warmUp();
    shows_ = true;
    report(Clock::now()); // viewers who come before the first tick are told the scene's own settings
}

// Those that were compiled before, here or in a process ahead, the driver has in its cache. What other threads make
// keeps no picture waiting.
void FrameLoop::pipelineMade(const std::string& text) {
    const bool news = ways_.addPipeline(text);
    if (!shows_) return;
    if (std::this_thread::get_id() != drawing_.load()) return spdlog::debug("a pipeline beside pictures: {}", text);
    ++pipelines_made_;
    if (!news) return spdlog::debug("pictures wait for a pipeline that is on disk: {}", text);
    metrics_.waitedForPipeline();
    spdlog::debug("pictures wait for a pipeline that no process has compiled ahead: {}", text);
}

// Drivers compile shaders when they are first used. Where they are compiled behind, only those of the first pictures
// are compiled here, wherever cameras are; else also those of measuring and of a picture at rest, which snapshots are.
// What may be needed later: ahead.h.
void FrameLoop::warmUp() {
    const Progress progress;
    const bool all = ways_.hasAll();
    WarmUp pictures(*renderer_, batches_.front()->submission, scene_, simulation_, all);
    const PlanView& own = pictures.own();
    const RenderSettings planned = planner_->settings(simulation_, {&own, 1}, false, Clock::now());
    if (all) {
        pictures.draw(planned, false);
        pictures.draw(planner_->once(simulation_, own).settings, true);
    } else if (ways_.has(planned, false)) {
        pictures.draw(planned, false);
    } else { // cameras that go anywhere are drawn this way until others are compiled
        const Clock::time_point begun = Clock::now();
        pictures.drawForEveryCamera(planned, false);
        const bool known = Clock::now() - begun < kKnown; // by the driver, and the shaders of measuring probably, too
        if (known) WarmUp(*renderer_, batches_.front()->submission, scene_, simulation_, true).draw(planned, false);
        ways_.add(shadersOf(planned, false), known);
    }
}

// Pictures show what commands made of the scene's lists once shaders for it are compiled, and what there was until
// then. The simulation waits for nothing.
void FrameLoop::followLists() {
    const SceneFeatures now = featuresOf(simulation_.now());
    if (!ways_.follow(now) || now == drawn_) return;
    drawn_ = now;
    planner_->draws(now);
    ++scene_version_;
    changed_ = replan_ = true;
}

// Goes on from another state of the same scene.
void FrameLoop::begin(std::span<const std::byte> state) {
    simulation_.load(state);
    ++scene_version_;
    changed_ = replan_ = true;
    if (ticked_) ticked_(simulation_, {}, false);
}

std::future<void> FrameLoop::show(NextScene next) {
    const std::scoped_lock lock(mutex_);
    next_.emplace(std::move(next));
    shown_ = {};
    return shown_.get_future();
}

// Shows the scene that waits, if there is one. Nothing of the old one is on the device.
void FrameLoop::takeScene() {
    std::optional<NextScene> next;
    std::promise<void> shown;
    {
        const std::scoped_lock lock(mutex_);
        if (!next_) return;
        next = std::exchange(next_, std::nullopt);
        shown = std::exchange(shown_, {});
    }
    renderer_.reset(); // makes room for the other
    std::shared_ptr<const SceneFacts> facts;
    try {
        renderer_.emplace(device_, next->scene, boundedCapacity(next->scene, next->simulation, memory_));
        facts = sceneFacts(next->scene, std::move(next->others));
        next->simulation.countFrom(simulation_.tick() + 1); // a tick has one state
        if (next->on_show) next->on_show(next->simulation);
    } catch (const gpu::DeviceLost&) {
        throw;
    } catch (const std::exception&) { // also std::bad_alloc: the old scene is shown again
        const std::exception_ptr reason = std::current_exception();
        renderer_.reset();
        next.reset(); // its particles' memory may be what the old scene lacks
        renderer_.emplace(device_, scene_, simulation_.capacity());
        return shown.set_exception(reason);
    }
    scene_ = std::move(next->scene);
    shown_scene_ = std::make_shared<const Scene>(scene_);
    meter_.forget();
    errors_.clear();
    promise_ = {};
    simulation_ = std::move(next->simulation);
    drawn_ = featuresOf(simulation_.now());
    ways_.clear(drawn_);
    planner_.emplace(scene_, costs_, frame_ms_, &ways_);
    priced_.reset();
    list_ms_ = 0;
    ++scene_version_;
    replan_ = true;
    audience_.setScene(std::move(facts));
    audience_.prepare({}); // it is there
    report(Clock::now());
    shown.set_value();
}

} // namespace brume

// FrameLoop: takes commands, steps the simulation, renders due viewers in batches, encodes and delivers their frames.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "common/other_work.h"
#include "server/encode/workers.h"
#include "server/error/error_meter.h"
#include "server/frame_options.h"
#include "server/gpu/pipeline_cache.h"
#include "server/loop/batch_planner.h"
#include "server/loop/device_ledger.h"
#include "server/loop/promise_watch.h"
#include "server/loop/tick_source.h"
#include "server/metrics/metrics.h"
#include "server/plan/planner.h"
#include "server/render/renderer.h"
#include "server/render/room.h"
#include "server/viewer/audience.h"
#include "server/viewer/refinement.h"

namespace brume {

class FrameLoop {
public:
    using Options = FrameOptions;

    // Draws one picture that nobody sees, so that the first viewer does not wait for its shaders. `device`,
    // `audience` and `metrics` outlive the loop. Throws SceneError, gpu::Error.
    FrameLoop(const Scene& scene, const gpu::Device& device, Audience& audience, Metrics& metrics,
              const Options& options);
    // Stops, and waits for the device and the encoders.
    ~FrameLoop();

    // Starts the loop on its own thread. `on_failure` is called there once if the loop cannot go on; see failure().
    // `ticks`: source of ticks and commands; null: the clock and the audience's commands.
    void start(std::function<void()> on_failure, std::unique_ptr<TickSource> ticks = nullptr);
    void stop();
    // Sets Options::frame_ms from the next tick on. Thread-safe.
    void setFrameBudget(double frame_ms) { frame_ms_ = frame_ms; }
    // Sets Options::law_factor from the next tick on. Thread-safe.
    void setLawFactor(double factor) { law_factor_ = factor; }
    // The ways whose shaders are compiled: all, or with Options::compiled_behind those that were added.
    CompiledWays& compiledWays() { return ways_; }
    // A scene that was loaded to be shown instead of the present one.
    struct NextScene {
        Scene scene;
        Simulation simulation;                          // made of `scene`, not stepped
        std::vector<std::string> others;                // SceneFacts::others
        std::function<void(const Simulation&)> on_show; // called on the loop's thread before the scene's first tick
    };
    // Shows another scene from the next tick on; ticks count on, commands and viewers stay. The future is ready once it
    // is shown, or has the exception for which the old scene stays: SceneError, gpu::Error, std::bad_alloc or what
    // on_show threw. A scene that waits is replaced by a later one. Thread-safe.
    std::future<void> show(NextScene next);
    // The exception that ended the loop; null if there was none.
    std::exception_ptr failure() const { return failure_; }

private:
    // One batch of pictures: first on the device, then with the encoders, then free for reuse.
    struct Batch : BatchContents {
        explicit Batch(const gpu::Device& device) : submission(device, "batch") {}

        Submission submission;
        uint64_t tick = 0, state_hash = 0;
        Clock::time_point taken{}, done{}; // when its poses were taken; when the device was done
        // True: drawn with finer() settings. For still pictures, and for others if there is time.
        bool finer = false;
        float error = 0;                    // predicted relative RMSE of its pictures, at most
        std::atomic<uint32_t> pending{0};   // jobs not encoded yet
        bool compiled = false;              // True: its shaders were compiled meanwhile, so its times tell nothing
        bool spare = false;                 // True: its pictures' memory is to be freed as soon as nobody reads them
        RenderSettings settings;            // that it is drawn with
        std::unique_ptr<MeterJob> measured; // pixels that are read back with it; null: none
    };

    void warmUp();
    void pipelineMade(const std::string& text);
    void run();
    void tick();
    void tellRefused();
    void followTicks(bool sought);
    void followLists();
    void takeScene();
    void begin(std::span<const std::byte> state);
    Batch* freeBatch();
    const RenderSettings& plannedSettings(const Batch& batch);
    bool render(Batch& batch);
    bool renderOneShot(Batch& batch);
    bool submit(Batch& batch, const RenderSettings& settings);
    uint64_t mostPlaneBytes() const;
    bool hasSeveralHues() const;
    void giveBack(Clock::time_point now);
    uint64_t pictureBytes() const;
    void drop(Batch& batch, const char* why);
    void beginMeasuring(Batch& batch, const RenderSettings& settings);
    DrawnWith drawnWith(const RenderSettings& settings, const EyeRequest& eye) const;
    void showMeasured(Batch& batch);
    void endMeasuring(Batch& batch, bool drawn);
    void tellMeasured(Batch& batch, const std::string& method) const;
    void readMeter(Clock::time_point now);
    void learn(Clock::time_point now);
    void learnCosts(const Batch& batch, std::span<const gpu::PassSample> samples);
    void encode(Batch& batch);
    void deliver(const Batch& batch, uint32_t job, std::span<const PictureView> views, JpegEncoder& jpeg) noexcept;
    void tellLoad(Clock::time_point now);
    void priceLists();
    void report(Clock::time_point now);

    const gpu::Device& device_;
    Audience& audience_;
    Metrics& metrics_;
    Scene scene_;
    const std::function<void(const Simulation&, std::span<const Command>, bool)> ticked_;
    const CostModel costs_;
    const uint64_t memory_, picture_memory_; // bytes: FrameOptions::memory, picture_memory
    std::atomic<double> frame_ms_, law_factor_;
    const double most_frame_ms_;
    CompiledWays ways_;
    bool shows_ = false;                   // True: pictures may be waited for
    uint64_t pipelines_made_ = 0;          // for pictures
    std::atomic<std::thread::id> drawing_; // the thread that run() is in
    gpu::PipelineListener pipelines_;
    SceneFeatures drawn_; // of the scene's lists, in pictures
    Simulation simulation_;
    std::optional<Renderer> renderer_; // made anew after a submission failed
    std::optional<Planner> planner_;
    std::unique_ptr<TickSource> ticks_;

    std::vector<std::unique_ptr<Batch>> batches_;
    Batch* on_device_ = nullptr;
    uint64_t rendered_tick_ = ~0ull; // tick of the last batch
    std::vector<Command> commands_;
    std::vector<std::shared_ptr<Viewer>> viewers_;
    BatchPlanner batch_planner_;
    std::vector<uint32_t> held_; // viewers whose one-shot pictures wait for shaders
    uint64_t held_with_ = 0;     // CompiledWays::version() when they were looked at
    Clock::time_point held_since_{};
    DeviceLedger ledger_;
    Room room_; // what the pictures' buffers needed lately
    Refinement refinement_;
    ErrorMeter meter_;
    const bool learns_costs_;
    const std::function<void(const CostModel&)> on_costs_;
    const std::function<void(uint64_t, std::span<const ViewError>, const Plan&)> on_errors_;
    std::shared_ptr<const Scene> shown_scene_; // equal to scene_; jobs of the meter keep it
    OtherWork other_work_;
    Clock::time_point costs_learnt_{}, costs_told_{};
    std::vector<uint32_t> drawn_viewers_;      // viewers of a batch whose pictures are drawn
    std::vector<gpu::ErrorDisc> shown_errors_; // of the batch's eyes that look at them
    std::vector<ViewError> errors_;            // what meter_ knew at load_told_
    PromiseWatch promise_;
    std::optional<uint64_t> priced_; // Simulation::listsHash() for which lights were priced; nothing: none was
    double list_ms_ = 0;             // time that a picture may take with all lists; 0: not known yet
    Clock::time_point load_told_{}, reported_{};
    double most_full_ms_ = 0;          // largest predicted time of a batch with all due viewers, since load_told_
    bool replan_ = false;              // True: the last plan is of another scene, or of other features
    bool asked_ = false;               // True: commands changed something since the last plan
    bool drawn_before_ = false;        // True: the last pictures were drawn before the plan that commands asked for
    Clock::time_point next_asked_{};   // no plan is made before only because of commands
    bool changed_ = true;              // True: a command came since the last report
    uint64_t scene_version_ = 0;       // grows whenever pictures would change
    std::optional<bool> paused_;       // TickSource::paused() in the last report
    uint64_t pauses_ = 0;              // how often it was another
    const char* standstill_ = nullptr; // TickSource::standstill() in the last report
    bool serves_ = true;               // TickSource::serves() when Audience::ready was told

    EncodeWorkers workers_; // declared before the thread that uses it
    std::mutex mutex_;      // guards the next four
    std::condition_variable wake_;
    bool stopping_ = false;
    std::optional<NextScene> next_;
    std::promise<void> shown_; // answers who gave next_
    std::exception_ptr failure_;
    std::thread thread_;
};

} // namespace brume

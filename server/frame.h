// The way of the data, from commands to frames: the loop that every tick and every picture passes.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "server/encode/workers.h"
#include "server/frame_options.h"
#include "server/loop/batch_planner.h"
#include "server/loop/device_ledger.h"
#include "server/loop/tick_source.h"
#include "server/metrics/metrics.h"
#include "server/plan/planner.h"
#include "server/render/renderer.h"
#include "server/viewer/audience.h"
#include "server/viewer/refinement.h"

namespace brume {

class FrameLoop {
public:
    using Options = FrameOptions;

    // Draws one picture unseen, so that the first viewer does not wait for its shaders. Throws SceneError, gpu::Error. `device`,
    // `audience` and `metrics` outlive the loop.
    FrameLoop(const Scene& scene, const gpu::Device& device, Audience& audience, Metrics& metrics, const Options& options);
    // Stops and waits for what is on the device.
    ~FrameLoop();

    // Starts the loop on a thread of its own; null: LocalTicks of the audience's commands. `on_failure` is called from that
    // thread, once, when the loop cannot go on; see failure().
    void start(std::function<void()> on_failure, std::unique_ptr<TickSource> ticks = nullptr);
    void stop();
    // Options::frame_ms from the next tick on. Thread-safe.
    void setFrameBudget(double frame_ms) { frame_ms_ = frame_ms; }
    // True once the background shader compiler has finished: PlanInputs::compiled. Thread-safe.
    void setCompiled(bool compiled) { compiled_ = compiled; }
    // What ended the loop; null while all is well.
    std::exception_ptr failure() const { return failure_; }

private:
    // One tick's pictures: on the device, then with the encoders, then free again.
    struct Batch : BatchContents {
        explicit Batch(const gpu::Device& device) : submission(device, "batch") {}

        Submission submission;
        uint64_t tick = 0, state_hash = 0;
        Clock::time_point taken{}, done{}; // when poses were taken, and when the device was done
        bool low_error = false;            // True: half the distance between rays and slabs; every still picture, and others
                                           // where there is time
        std::atomic<uint32_t> pending{0};  // jobs not encoded yet
    };

    void warmUp();
    void run();
    void tick();
    Batch* freeBatch();
    bool render(Batch& batch);
    void drop(Batch& batch, const char* why);
    void encode(Batch& batch);
    void deliver(const Batch& batch, uint32_t job, std::span<const PictureView> views, JpegEncoder& jpeg) noexcept;
    void tellLoad(Clock::time_point now);
    void report(Clock::time_point now);

    const gpu::Device& device_;
    Audience& audience_;
    Metrics& metrics_;
    const Scene scene_;
    const std::function<void(const Simulation&, std::span<const Command>)> ticked_;
    std::atomic<double> frame_ms_;
    std::atomic<bool> compiled_{true};
    Simulation simulation_;
    std::optional<Renderer> renderer_; // made anew when a submission fails
    Planner planner_;
    std::unique_ptr<TickSource> ticks_;

    std::vector<std::unique_ptr<Batch>> batches_;
    Batch* on_device_ = nullptr;
    uint64_t rendered_tick_ = ~0ull; // of the last batch
    std::vector<Command> commands_;
    std::vector<std::shared_ptr<Viewer>> viewers_;
    BatchPlanner batch_planner_;
    DeviceLedger ledger_;
    Refinement refinement_;
    Clock::time_point load_told_{}, reported_{};
    double most_full_ms_ = 0;    // the most that a batch of all due viewers would have taken since load_told_, predicted
    bool replan_ = false;        // True: a command came since the last frame
    bool changed_ = true;        // True: a command came since the last report
    uint64_t scene_version_ = 0; // grows with everything that is seen

    EncodeWorkers workers_; // before the thread that uses it
    std::mutex mutex_;
    std::condition_variable wake_;
    bool stopping_ = false;
    std::exception_ptr failure_;
    std::thread thread_;
};

} // namespace brume

// The way of the data, from commands to frames: the loop that every tick and every picture passes.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>

#include "server/encode/workers.h"
#include "server/metrics/metrics.h"
#include "server/plan/planner.h"
#include "server/render/renderer.h"
#include "server/viewer/audience.h"
#include "server/viewer/refinement.h"
#include "server/viewer/schedule.h"

namespace brume {

class FrameLoop {
public:
    struct Options {
        unsigned encode_threads = 2;
        unsigned batches = 3;            // one on the device, the others being encoded
        double frame_ms = 50;            // that a frame of all viewers may take before accuracy is given up
        double refine_moving = 0.5;      // part of frame_ms that finer pictures may take while cameras rest and the medium moves
        uint64_t memory = 1024ull << 20; // bytes that particles may take, on the CPU and on the device together
        CostModel costs = builtInCosts();
        // Called before the first tick and after every one, on the loop's thread, with the commands that it took.
        std::function<void(const Simulation&, std::span<const Command>)> ticked;
    };

    // Throws SceneError, gpu::Error. `device`, `audience` and `metrics` outlive the loop.
    FrameLoop(const Scene& scene, const gpu::Device& device, Audience& audience, Metrics& metrics, const Options& options);
    // Stops and waits for what is on the device.
    ~FrameLoop();

    // Starts the loop on a thread of its own. `on_failure` is called from it, once, when it cannot go on; see failure().
    void start(std::function<void()> on_failure);
    void stop();
    // Options::frame_ms from the next tick on. From any thread.
    void setFrameBudget(double frame_ms) { frame_ms_ = frame_ms; }
    // Whether nobody compiles shaders ahead any more: PlanInputs::compiled. From any thread.
    void setCompiled(bool compiled) { compiled_ = compiled; }
    // What ended the loop; null while all is well.
    std::exception_ptr failure() const { return failure_; }

private:
    struct Batch;
    using Millis = std::chrono::duration<float, std::milli>;

    void warmUp();
    void run();
    void tick();
    Batch* freeBatch();
    void gather(Batch& batch, bool fine);
    void addJob(Batch& batch, const std::shared_ptr<Viewer>& viewer, const Viewer::Due& due);
    bool render(Batch& batch);
    void encode(Batch& batch);
    void countPasses(std::span<const gpu::PassSample> samples, uint32_t pictures);
    void shareTime(Batch& batch, std::span<const gpu::PassSample> samples, double shared_ms, double views_ms);
    void deliver(const Batch& batch, uint32_t job, std::span<const PictureView> views, JpegEncoder& jpeg);
    bool camerasRest(Clock::time_point now) const;
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
    Renderer renderer_;
    Planner planner_;

    std::vector<std::unique_ptr<Batch>> batches_;
    Batch* on_device_ = nullptr;
    uint64_t rendered_tick_ = ~0ull; // of the last batch
    std::vector<Command> commands_;
    std::vector<std::shared_ptr<Viewer>> viewers_;
    std::vector<EyeRequest> eyes_;
    std::vector<PlanView> views_; // the same, for the plan
    std::vector<PoseRequest> requests_;
    std::vector<Schedule::Wish> wishes_; // the same, and of viewers_
    Schedule schedule_;
    Refinement refinement_;
    Clock::time_point load_told_{};
    double whole_ms_ = 0; // of all viewers' pictures, the most since then
    bool replan_ = false; // a command came since the last frame
    std::vector<PassTime> passes_;
    Clock::time_point reported_{};
    uint64_t scene_version_ = 0; // of all that is seen
    bool changed_ = true;        // a command came since the last report

    EncodeWorkers workers_; // before the thread that uses it
    std::mutex mutex_;
    std::condition_variable wake_;
    bool stopping_ = false;
    std::exception_ptr failure_;
    std::thread thread_;
};

} // namespace brume

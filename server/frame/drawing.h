// Drawing: takes the newest poses of viewers who are due, draws their pictures in batches, and has them encoded.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "server/frame/encoding.h"
#include "server/frame/lit_stream.h"
#include "server/frame/measuring.h"
#include "server/frame/planning.h"
#include "server/gpu/pipeline_cache.h"
#include "server/loop/device_ledger.h"
#include "server/loop/medium_pace.h"
#include "server/loop/scene_report.h"
#include "server/render/idle_memory.h"
#include "server/viewer/audience.h"
#include "server/viewer/refinement.h"

namespace brume {

class Drawing {
public:
    // Draws a few pictures that nobody sees, so that the first viewer waits for no shaders. All but `options`
    // outlive it. Throws SceneError, gpu::Error.
    Drawing(ShownScene& shown, const gpu::Device& device, Audience& audience, Metrics& metrics,
            const FrameOptions& options);

    // Frames of all viewers may take so long, in ms; laws are wrong by this factor: FrameOptions.
    void setBudget(double frame_ms, double law_factor);
    Planning& planning() { return planning_; }
    MediumPace& pace() { return pace_; }
    CompiledWays& ways() { return ways_; }

    // True: a batch, or the light of a tick, is on the device.
    bool isBusy() const { return on_device_ != nullptr || lit_.isOnDevice(); }
    // Waits at most so long for the batch on the device, and then has its pictures encoded. Precondition: isBusy().
    void wait(std::chrono::nanoseconds longest);
    // True: a picture would show something new, or somebody waits.
    bool isDue() const;
    // Takes the newest poses of viewers who are due and submits their pictures, if there are any. Precondition: nothing
    // is on the device.
    void draw();
    // Frees the memory of pictures when they have been smaller, or none, for a minute. Precondition: nothing is on the
    // device.
    void giveBack(Clock::time_point now);

    // Makes a renderer for this scene, after the memory of the one before is free. Throws gpu::Error. Precondition:
    // nothing is on the device.
    void prepare(const Scene& scene, uint32_t capacity);
    // The scene that is shown is another one from now on. Precondition: it was prepared.
    void showScene();

    // Tells viewers how much of the device's time they have, and what was measured. Every 100 ms.
    void tellLoad(Clock::time_point now);
    // What there is to say of the device.
    void report(SceneReport& report) const;

private:
    void warmUp();
    void pipelineMade(const std::string& text);
    Batch* freeBatch();
    bool render(Batch& batch);
    bool light();
    bool renderOneShot(Batch& batch);
    void askForLayers(Batch& batch, const RenderSettings& settings);
    bool submit(Batch& batch, const RenderSettings& settings);
    void drop(Batch& batch, const char* why);
    void done(Batch& batch);
    uint64_t mostPlaneBytes() const;
    uint64_t pictureBytes() const;

    ShownScene& shown_;
    const gpu::Device& device_;
    Audience& audience_;
    Metrics& metrics_;
    const uint64_t picture_memory_; // bytes: FrameOptions::picture_memory
    const double most_frame_ms_;
    double frame_ms_;

    CompiledWays ways_;
    bool shows_ = false;                     // True: pictures may be waited for
    uint64_t pipelines_made_ = 0;            // for pictures
    std::atomic<std::thread::id> submitter_; // the thread that submits pictures
    gpu::PipelineListener pipelines_;
    std::optional<Renderer> renderer_; // made anew after a submission failed
    Planning planning_;
    Measuring measuring_;
    MediumPace pace_;

    std::vector<std::unique_ptr<Batch>> batches_;
    Batch* on_device_ = nullptr;
    uint64_t rendered_tick_ = ~0ull; // tick of the last batch
    std::vector<std::shared_ptr<Viewer>> viewers_;
    std::vector<uint32_t> ids_; // of viewers
    BatchPlanner batch_planner_;
    std::vector<uint32_t> deferred_; // viewers whose one-shot pictures wait for shaders
    uint64_t deferred_with_ = 0;     // CompiledWays::version() when they were looked at
    Clock::time_point deferred_since_{};
    std::optional<uint64_t> layers_wait_; // CompiledWays::version() when pictures last went without their layers
    DeviceLedger ledger_;
    IdleMemory idle_memory_; // of the pictures' buffers
    Refinement refinement_;
    double most_full_ms_ = 0; // largest predicted time of a batch with all due viewers, since tellLoad()

    LitStream lit_;
    Encoding encoding_; // the last member: its threads use the batches and lit_
};

} // namespace brume

// Batch: the pictures of one submission, first on the device, then with the encoders, then free for reuse.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "server/encode/cut_out.h"
#include "server/error/error_meter.h"
#include "server/loop/batch_planner.h"
#include "server/render/renderer.h"

namespace brume {

struct Batch : BatchContents {
    explicit Batch(const gpu::Device& device) : submission(device, "batch") {}

    Submission submission;
    uint64_t tick = 0, state_hash = 0;
    Clock::time_point taken{}, done{}; // when its poses were taken; when the device was done
    // True: drawn with less error than the plan's way: still and one-shot pictures, and moving ones if there is time.
    bool finer = false;
    float error = 0;                    // predicted relative RMSE of its pictures, at most
    std::atomic<uint32_t> pending{0};   // jobs not encoded yet
    bool waited = false;                // True: it waited for shaders to be compiled, so its times tell nothing
    bool spare = false;                 // True: its pictures' memory is to be freed as soon as nobody reads them
    RenderSettings settings;            // that it is drawn with
    std::unique_ptr<MeterJob> measured; // pixels that are read back with it; null: none

    std::optional<RawPicture> raw; // of a one-shot picture with alpha, in place of its planes

    bool isFree() const { return pending.load() == 0; }
    // True: the job's pictures are drawn for it; false: they are those of another one.
    bool isDrawnFor(const BatchJob& job) const { return &job == &jobs[job.pictures]; }
};

} // namespace brume

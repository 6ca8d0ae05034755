// LitStream: the lit medium for viewers who draw by themselves. It is made once a tick for all of them, apart from
// pictures.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "server/encode/workers.h"
#include "server/frame/lit_rows.h"
#include "server/frame/measuring.h"
#include "server/frame/shown_scene.h"
#include "server/medium/lasting_groups.h"
#include "server/metrics/metrics.h"
#include "server/viewer/viewer.h"

namespace brume {

// Why viewers cannot draw this scene by themselves, one line; empty: they can.
std::string whyNotDrawable(const ShownScene& shown);

class LitStream {
public:
    // All outlive it. `most_rate`: bytes a second for each viewer, if an eighth of all messages is not more.
    LitStream(const gpu::Device& device, Metrics& metrics, Measuring& measuring, double most_rate);

    // True: somebody who draws by himself should get a message. `viewers`: all. Precondition: isBusy() is false.
    bool isDue(std::span<const std::shared_ptr<Viewer>> viewers, const ShownScene& shown, Clock::time_point now) const;
    // True: particles are lit on the device.
    bool isOnDevice() const { return on_device_; }
    // Has the present tick's particles lit, for the viewers who are due. Precondition: isDue() was true for these.
    void submit(Renderer& renderer, const ShownScene& shown, const RenderSettings& settings,
                std::span<const std::shared_ptr<Viewer>> viewers, Clock::time_point now);
    // Waits at most so long for the device; then has the message packed by the workers. Precondition: isOnDevice().
    void wait(std::chrono::nanoseconds longest, EncodeWorkers& workers);
    // Forgets what is on the device: it was lost, or nothing was submitted.
    void drop();

    uint64_t bytes() const { return bytes_; } // of the CPU's memory, for rows of earlier messages

private:
    void pack() noexcept;
    std::span<const gpu::Particle> grouped(const ShownScene& shown);
    double hzWithin(double hz) const;
    double hzFor(std::span<const std::shared_ptr<Viewer>> viewers) const;

    struct Job {
        std::shared_ptr<Viewer> viewer;
        Viewer::Due due;
        MeasuredError measured; // of this viewer's pictures
    };

    Metrics& metrics_;
    Measuring& measuring_;
    const double most_rate_;
    Submission submission_;
    bool on_device_ = false;
    std::atomic<bool> packing_{false}; // True: a worker reads what is below
    std::vector<Job> jobs_;
    std::vector<Measuring::Drawer> drawers_; // of jobs_
    std::shared_ptr<LitTick> next_;          // what is on the device, without rows
    std::unique_ptr<MeterJob> measured_;     // of one of the viewers; null: none
    LastingGroups groups_;                   // of a large medium
    uint64_t groupings_ = 0;                 // how often it was grouped
    uint32_t grouped_at_ = 0;                // number of the message that was the first with these groups
    std::vector<gpu::Particle> particles_, merged_;
    bool whole_ = false; // True: somebody needs whole rows
    uint64_t first_ = 0;
    Clock::time_point taken_{}, done_{};
    uint32_t number_ = 0; // of the newest message
    std::optional<uint64_t> version_;
    lit::Packer packer_;
    std::array<std::pair<uint32_t, lit::Rows>, lit::kLayers> rows_; // the newest of each layer, with its number
    std::array<std::atomic<double>, lit::kLayers> sizes_{};         // bytes of messages of each layer, smoothed
    std::atomic<uint64_t> bytes_{0};
};

} // namespace brume

// FakeRenderer: a frame loop without a renderer. It answers every due pose with text that repeats the request, and
// publishes reports.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstring>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "server/metrics/metrics.h"
#include "server/viewer/audience.h"
#include "tests/unit/take_due.h"

namespace brume {

// The "JPEG" of one view: SOI, a line of text, padding, EOI.
inline std::vector<uint8_t> fakeJpeg(const PoseRequest& request, int view, size_t bytes) {
    const glm::vec3& at = request.pose.position;
    std::string jpeg = fmt::format("\xff\xd8seq {} eye {} at {} {} {} size {}x{} quality {}", request.seq, view, at.x,
                                   at.y, at.z, request.width, request.height, request.quality);
    if (jpeg.size() + 2 < bytes) jpeg.resize(bytes - 2);
    jpeg += "\xff\xd9";
    return {jpeg.begin(), jpeg.end()};
}

class FakeRenderer {
public:
    std::atomic<bool> paused{false};          // True: renders nothing, takes no command
    std::atomic<size_t> jpeg_bytes{0};        // least size of a picture, by padding
    std::atomic<uint32_t> most_pixels{~0u};   // most pixels of a picture; a viewer that asks for more is refused
    std::atomic<uint64_t> rounds{0}, made{0}; // finished loops; rendered frames

    FakeRenderer(Audience& audience, Metrics& metrics) : audience_(audience), metrics_(metrics) {
        audience_.ready = true;
        thread_ = std::thread([this] { run(); });
    }
    ~FakeRenderer() {
        stop_ = true;
        thread_.join();
    }

    std::vector<Command> commands() const {
        const std::scoped_lock lock(mutex_);
        return commands_;
    }

private:
    void run() {
        SceneReport report;
        std::vector<std::shared_ptr<Viewer>> viewers;
        std::vector<Command> taken;
        while (!stop_) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            ++rounds;
            if (paused) continue;
            audience_.commands().drain(taken);
            for (const Command& command : taken) {
                if (const auto* set = std::get_if<Set>(&command.body))
                    for (const Change& change : set->changes) take(change, report);
                const std::scoped_lock lock(mutex_);
                commands_.push_back(command);
            }
            ++report.tick;
            report.state_hash = report.tick * 0x9e3779b97f4a7c15;
            report.particles = 500;
            report.passes = {{"sort", 0.5f}, {"medium", 7.25f}};
            audience_.publish(std::make_shared<SceneReport>(report));
            metrics_.ticked(0.25f);

            while (const auto request = audience_.particleRequests().take())
                request->answer({.scene = "fake", .tick = report.tick, .particles = {gpu::Particle{}}});

            audience_.list(viewers);
            for (const auto& viewer : viewers)
                if (const auto due = takeDue(*viewer)) answer(*viewer, *due, report);
        }
    }

    static void take(const Change& change, SceneReport& report) {
        const auto live = liveSettings();
        report.settings[size_t(std::find(live.begin(), live.end(), change.setting) - live.begin())] = change.value;
        ++report.settings_version;
    }

    void answer(Viewer& viewer, const Viewer::Due& due, const SceneReport& report) {
        if (uint32_t{due.request.width} * due.request.height <= most_pixels) return viewer.deliver(render(due, report));
        viewer.abandon(due.frame_id);
        viewer.refuse("ask for smaller pictures");
    }

    FramePtr render(const Viewer::Due& due, const SceneReport& report) {
        auto frame = std::make_shared<EncodedFrame>();
        frame->id = due.frame_id;
        frame->tick = report.tick;
        frame->state_hash = report.state_hash;
        frame->request = due.request;
        frame->error = 0.0125f;
        frame->png = due.request.lossless;
        frame->wait_ms = 1, frame->render_ms = 2, frame->encode_ms = 3, frame->gpu_ms = 1.5f;
        for (int view = 0; view < due.request.views; ++view)
            frame->jpeg[size_t(view)] =
                std::make_shared<const std::vector<uint8_t>>(fakeJpeg(due.request, view, jpeg_bytes));
        frame->encoded = Clock::now();
        metrics_.rendered(*frame);
        ++made;
        return frame;
    }

    Audience& audience_;
    Metrics& metrics_;
    std::atomic<bool> stop_{false};
    mutable std::mutex mutex_;
    std::vector<Command> commands_;
    std::thread thread_;
};

} // namespace brume

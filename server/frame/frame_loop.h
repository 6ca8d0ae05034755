// FrameLoop: takes commands, steps the simulation, has pictures drawn, and shows another scene when it is asked to.
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

#include "server/frame/drawing.h"
#include "server/loop/device_turns.h"
#include "server/loop/pointing.h"
#include "server/loop/tick_source.h"

namespace brume {

class FrameLoop {
public:
    using Options = FrameOptions;

    // Draws a few pictures that nobody sees, so that the first viewer waits for no shaders. `device`,
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
    CompiledWays& compiledWays() { return drawing_.ways(); }
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
    std::future<void> replaceScene(NextScene next);
    // The exception that ended the loop; null if there was none.
    std::exception_ptr failure() const { return failure_; }

private:
    void run();
    bool mayDraw();
    void tick();
    void tellRefused();
    void followTicks(bool sought);
    void followLists();
    void takeScene();
    void giveParticles();
    void goOnFrom(std::span<const std::byte> state);
    void changed();
    void report(Clock::time_point now);

    Audience& audience_;
    Metrics& metrics_;
    const std::function<void(const Simulation&, std::span<const Command>, bool)> ticked_;
    const uint64_t memory_; // bytes: FrameOptions::memory
    std::atomic<double> frame_ms_, law_factor_;
    ShownScene shown_;
    Drawing drawing_;
    std::unique_ptr<TickSource> ticks_;
    Pointing pointing_;
    std::vector<Command> commands_;
    std::vector<std::shared_ptr<Viewer>> viewers_;

    // What viewers were told last.
    struct Told {
        bool stale = true; // True: a command came, or the ticks do something else
        std::optional<bool> paused;
        uint64_t pauses = 0; // how often `paused` was another
        const char* standstill = nullptr;
        bool serves = true; // TickSource::serves() when Audience::ready was told
        Clock::time_point at{}, load_at{};
    } told_;

    std::mutex mutex_; // guards the next five
    std::condition_variable wake_;
    bool stopping_ = false;
    bool turn_ = false; // True: it may be this loop's turn on the device
    std::optional<NextScene> next_;
    std::promise<void> next_is_shown_; // answers who gave next_
    std::exception_ptr failure_;
    std::optional<DeviceTurns::Seat> seat_; // nothing: the device is this loop's alone
    std::thread thread_;
};

} // namespace brume

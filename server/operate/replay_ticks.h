// ReplayTicks: a recording as the source of ticks of a server that viewers look at. It compares every recorded state.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "server/operate/recorded_ticks.h"
#include "server/viewer/replay_control.h"

namespace brume {

// Reads all of a recording. Throws RecordingError.
struct RecordingExtent {
    explicit RecordingExtent(const std::filesystem::path& file);

    RecordingHead head;
    uint64_t last = 0; // tick of the last record
};
// The scene that a recording begins with. Throws SceneError.
Scene sceneOf(const RecordingHead& head);

class ReplayTicks final : public TickSource {
public:
    // The first tick is due at `begin`. Throws RecordingError, as other functions do where the file has changed.
    ReplayTicks(std::filesystem::path file, std::shared_ptr<ReplayControl> control, Clock::time_point begin);

    Clock::time_point due() const override { return seeks() ? Clock::time_point::min() : next_; }
    bool take(Clock::time_point now, std::vector<Command>& commands) override;
    std::optional<std::vector<std::byte>> beginning() override;
    bool stands() const override { return !seeks() && (control_->paused || tick_ >= control_->last); }
    bool seeks() const override { return target_.has_value(); }
    std::optional<bool> paused() const override { return control_->paused; }

    // To be called with the state before the first tick, and after every tick. Logs the first difference.
    void check(const Simulation& simulation);

private:
    void open();
    void arrive();

    const std::filesystem::path file_;
    const std::shared_ptr<ReplayControl> control_;
    std::unique_ptr<RecordingReader> recording_;
    std::unique_ptr<RecordedTicks> recorded_;
    Clock::time_point next_;
    std::vector<std::byte> start_;         // the state before the first tick
    uint64_t tick_ = 0, state_hash_ = 0;   // present
    uint64_t number_ = 0;                  // of the last seek
    std::optional<uint64_t> target_;       // tick of a seek that is under way
    bool differs_ = false, ended_ = false; // True: that was logged
};

} // namespace brume

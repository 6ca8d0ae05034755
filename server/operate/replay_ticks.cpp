#include "server/operate/replay_ticks.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "common/scene_text.h"
#include "server/sim/point_cloud.h"

namespace brume {

RecordingExtent::RecordingExtent(const std::filesystem::path& file) {
    RecordingReader recording(file);
    head = recording.head();
    last = head.tick;
    while (const auto record = recording.next()) last = record->tick;
}

Scene sceneOf(const RecordingHead& head) {
    Scene scene = sceneOf(head.text, head.file, head.overrides);
    placeCamera(scene);
    return scene;
}

ReplayTicks::ReplayTicks(std::filesystem::path file, std::shared_ptr<ReplayControl> control, Clock::time_point begin)
    : file_(std::move(file)), control_(std::move(control)), next_(begin) {
    open();
}

void ReplayTicks::open() {
    auto recording = std::make_unique<RecordingReader>(file_);
    auto recorded = std::make_unique<RecordedTicks>(*recording);
    recorded_ = std::move(recorded); // it reads what follows
    recording_ = std::move(recording);
    tick_ = recording_->head().tick;
}

// A seek backwards begins anew: states cannot be taken back.
std::optional<std::vector<std::byte>> ReplayTicks::beginning() {
    const ReplayControl::Seek wanted = control_->wanted();
    if (wanted.number == number_) return {};
    number_ = wanted.number;
    target_ = wanted.tick;
    if (*target_ >= tick_) {
        arrive();
        return {};
    }
    try {
        open();
    } catch (const RecordingError& error) { // somebody changed the file
        spdlog::error("no seek to tick {}: {}", wanted.tick, error.what());
        target_.reset();
        control_->arrived({number_, tick_, state_hash_}); // where it is
        return {};
    }
    return start_;
}

bool ReplayTicks::take(Clock::time_point now, std::vector<Command>& commands) {
    constexpr std::chrono::milliseconds kMostBehind{250}; // as LocalTicks
    if (seeks()) {
        next_ = now + kTick;
    } else {
        if (now - next_ > kMostBehind) next_ = now;
        if (next_ > now) return false;
        if (stands()) {
            next_ = now + kTick;
            return false;
        }
        next_ += kTick;
    }
    if (!recorded_->take(now, commands)) return false;
    ++tick_;
    return true;
}

void ReplayTicks::check(const Simulation& simulation) {
    if (start_.empty()) simulation.save(start_);
    state_hash_ = simulation.stateHash();
    for (const RecordedTick& record : recorded_->records()) {
        if (record.state_hash != state_hash_ && !std::exchange(differs_, true))
            spdlog::error("replay: the first difference is at tick {}: state {}, recorded {}; what follows is not the "
                          "recorded session",
                          tick_, hexOf(state_hash_), hexOf(record.state_hash));
        if (tick_ == control_->last && !std::exchange(ended_, true))
            spdlog::info("replay: the recording ends at tick {} ({}): the scene stands still", tick_,
                         record.end.empty() ? "the server was killed or still records" : record.end);
    }
    arrive();
}

// Ends the seek where it is reached.
void ReplayTicks::arrive() {
    if (target_ != tick_) return;
    target_.reset();
    control_->arrived({number_, tick_, state_hash_});
}

} // namespace brume

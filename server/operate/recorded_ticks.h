// The ticks of a recording: each is due at once, and takes the commands that it took then.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/loop/tick_source.h"
#include "server/operate/recording.h"

namespace brume {

class RecordedTicks final : public TickSource {
public:
    // `recording` outlives this. Throws RecordingError, as take() does.
    explicit RecordedTicks(RecordingReader& recording) : recording_(recording), next_(recording.next()) { collect(); }

    Clock::time_point due() const override { return next_ ? Clock::time_point::min() : Clock::time_point::max(); }
    bool take(Clock::time_point /*now*/, std::vector<Command>& commands) override;

    // The records of the tick that was taken last, at first of the state before any; most ticks have none.
    std::span<const RecordedTick> records() const { return records_; }

private:
    void collect();

    RecordingReader& recording_;
    uint64_t tick_ = 0;
    std::optional<RecordedTick> next_; // the first record of a later tick
    std::vector<RecordedTick> records_;
};

} // namespace brume

// RecordedTicks: a tick source that reads a recording. Each tick is due at once and gets its recorded commands.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/loop/tick_source.h"
#include "server/operate/recording.h"

namespace brume {

class RecordedTicks final : public TickSource {
public:
    // `recording` outlives this. The constructor and take() throw RecordingError.
    explicit RecordedTicks(RecordingReader& recording)
        : recording_(recording), tick_(recording.head().tick), next_(recording.next()) {
        collect();
    }

    Clock::time_point due() const override { return next_ ? Clock::time_point::min() : Clock::time_point::max(); }
    bool take(Clock::time_point /*now*/, std::vector<Command>& commands) override;

    // Records of the tick taken last; most ticks have none. Before the first take(): those of the state before the
    // first tick.
    std::span<const RecordedTick> records() const { return records_; }

private:
    void collect();

    RecordingReader& recording_;
    uint64_t tick_;
    std::optional<RecordedTick> next_; // the first record of a later tick
    std::vector<RecordedTick> records_;
};

} // namespace brume

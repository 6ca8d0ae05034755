#include "server/operate/recorded_ticks.h"

#include <utility>

namespace brume {

bool RecordedTicks::take(Clock::time_point, std::vector<Command>& commands) {
    commands.clear();
    if (!next_) return false;
    ++tick_;
    collect();
    for (const RecordedTick& record : records_)
        commands.insert(commands.end(), record.commands.begin(), record.commands.end());
    return true;
}

// A server that ends at a tick that it has written already writes it once more.
void RecordedTicks::collect() {
    records_.clear();
    while (next_ && next_->tick <= tick_) {
        records_.push_back(*std::move(next_));
        next_ = recording_.next();
    }
}

} // namespace brume

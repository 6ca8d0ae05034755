// Where ticks come from: when the next one is due, and which commands it takes.
#pragma once

#include <optional>
#include <vector>

#include "server/sim/command.h"
#include "server/sim/simulation.h"
#include "server/viewer/frame.h"

namespace brume {

inline constexpr auto kTick = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kTickSeconds));

class TickSource {
public:
    virtual ~TickSource() = default;
    // When the next tick is due; Clock::time_point::max() when there are no more.
    virtual Clock::time_point due() const = 0;
    // Takes the next tick if it is due at `now`: `commands` are then those that it takes, in order. False if none is
    // due.
    virtual bool take(Clock::time_point now, std::vector<Command>& commands) = 0;

    // A state to go on from instead of the present one, as Simulation::save() gives it; nothing: the present one. Asked
    // for before each look at ticks.
    virtual std::optional<std::vector<std::byte>> beginning() { return {}; }
    // True: no tick comes by itself, and viewers get pictures of the present one as their cameras move.
    virtual bool stands() const { return false; }
    // True: ticks are on their way to one that is wanted, and none before it is drawn.
    virtual bool seeks() const { return false; }
    // Why no tick comes though one should, one line that lives for ever. Null: ticks come.
    virtual const char* standstill() const { return nullptr; }
    // True: this server has the state that viewers come for. False: they had better go to another.
    virtual bool serves() const { return true; }
    // What viewers are told of simulation.paused; nothing: what the simulation says.
    virtual std::optional<bool> paused() const { return {}; }
};

// Sixty ticks a second of this machine's clock, with what viewers have asked for until then.
class LocalTicks final : public TickSource {
public:
    // `queue` outlives this. The first tick is due at `begin`.
    LocalTicks(CommandQueue& queue, Clock::time_point begin) : queue_(&queue), next_(begin) {}

    Clock::time_point due() const override { return next_; }
    bool take(Clock::time_point now, std::vector<Command>& commands) override {
        if (now - next_ > kMostBehind) next_ = now;
        if (next_ > now) return false;
        next_ += kTick;
        queue_->drain(commands);
        return true;
    }

private:
    // When this far behind, time passes without ticks: a process that was stopped does not fast-forward.
    static constexpr std::chrono::milliseconds kMostBehind{250};

    CommandQueue* queue_; // never null
    Clock::time_point next_;
};

} // namespace brume

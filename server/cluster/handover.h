// Handover: what the thread that follows the log gives to the frame loop, and what it gets back. Thread-safe.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/sim/simulation.h"
#include "server/viewer/frame.h"

namespace brume::cluster {

// Where a state is in the log.
struct LogPoint {
    uint64_t sequence = 0; // of the message that it follows from
    uint64_t message = 0;  // hash of that message; 0: there is none yet
    std::string log;       // Log::save() after that message
};
// A state at its point of the log.
struct SavedState {
    uint64_t tick = 0, hash = 0; // of the simulation
    LogPoint at;
    std::vector<std::byte> simulation; // Simulation::save()
};

class Handover {
public:
    // Both are called on the frame loop's thread: `saved` with a state that was asked for, `passed` with the number of
    // every tick.
    Handover(std::function<void(SavedState)> saved, std::function<void(uint64_t)> passed)
        : saved_(std::move(saved)), passed_(std::move(passed)) {}

    // --- the log's thread ---
    // Ticks up to `last`, the first of which takes the commands. `save`: the state after the last is asked for.
    void give(uint64_t last, std::vector<Command> commands, std::optional<LogPoint> save);
    // A state to go on from, Simulation::save(), of this tick. Ticks that were not taken are forgotten.
    void begin(std::vector<std::byte> state, uint64_t tick);
    // The frame loop ends with this exception.
    void fail(std::exception_ptr failure);
    void stand(const char* why); // TickSource::standstill()
    // True: this server is none that viewers should come to, though it goes on. See TickSource::serves().
    void standAside(bool aside) { aside_ = aside; }
    uint64_t behind() const; // ticks that were given and not taken
    // The hash of the state after a tick. Nothing: it is not known, or not any more.
    std::optional<uint64_t> hashOf(uint64_t tick) const;
    std::pair<uint64_t, uint64_t> present() const; // the last tick that was taken, and its hash

    // --- the frame loop's thread ---
    bool take(std::vector<Command>& commands); // false: no tick is there
    std::optional<std::vector<std::byte>> beginning();
    const char* standstill() const;
    void ticked(const Simulation& simulation); // after every tick, and after a beginning
    bool aside() const { return aside_; }

private:
    // Ticks that follow from one message.
    struct Run {
        uint64_t last = 0;
        std::vector<Command> commands; // of its first tick
        std::optional<LogPoint> save;
    };
    static constexpr size_t kHashes = 1024;

    const std::function<void(SavedState)> saved_;
    const std::function<void(uint64_t)> passed_;
    mutable std::mutex mutex_;
    std::deque<Run> runs_;
    uint64_t given_ = 0, taken_ = 0; // last tick that was given, and taken
    std::optional<LogPoint> save_;   // of the tick that was taken last
    std::optional<std::vector<std::byte>> beginning_;
    std::exception_ptr failure_;
    const char* standstill_ = nullptr;
    std::atomic<bool> aside_{false};
    struct Known {
        uint64_t tick = 0, hash = 0;
    };
    std::array<Known, kHashes> hashes_{};
    Known present_;
};

} // namespace brume::cluster

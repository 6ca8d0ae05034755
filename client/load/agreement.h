// Compares the states that servers of one shared simulation tell for the same ticks.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace brume::load {

class Agreement {
public:
    // Two servers that told different states of one tick.
    struct Difference {
        uint64_t tick = 0;
        size_t server = 0, other = 0; // numbers of the servers
        uint64_t hash = 0, other_hash = 0;
    };

    // A server told the hash of the simulation's state at a tick. Ticks that are kWindow or more behind the newest in
    // their place are passed over.
    void told(size_t server, uint64_t tick, uint64_t hash);

    uint64_t compared() const { return compared_; } // ticks that two servers or more have told
    uint64_t equal() const { return compared_ - different_; }
    // The one of the smallest tick; none: all are equal.
    const std::optional<Difference>& first() const { return first_; }

    static constexpr size_t kWindow = 4096; // ticks that are remembered; a minute is 3600

private:
    struct Word {
        size_t server;
        uint64_t hash;
    };
    struct Tick {
        uint64_t tick = 0;
        std::vector<Word> words; // one of each server that told this tick
        bool different = false;  // true: it is counted in different_
    };

    std::vector<Tick> window_{kWindow}; // tick t is at t mod kWindow
    uint64_t compared_ = 0, different_ = 0;
    std::optional<Difference> first_;
};

} // namespace brume::load

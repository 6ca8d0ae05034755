// Snapshots: states of a cluster's simulation in the engine, from which a server that joins goes on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/cluster/engine.h"
#include "server/cluster/handover.h"

namespace brume::cluster {

// What a snapshot says of itself.
struct Manifest {
    uint64_t tick = 0, hash = 0;
    uint64_t sequence = 0;            // of the last message of the log that is in it
    uint64_t message = 0;             // hashOf() it
    int64_t created = 0;              // Engine::LogInfo::created of that log
    uint64_t bytes = 0, checksum = 0; // of its parts together, XXH3
};

class Snapshots {
public:
    explicit Snapshots(Engine& engine) : engine_(engine) {}

    // Writes one in place of the older of the two, or of one that is no good. Returns its size in bytes. Throws
    // EngineAway.
    uint64_t write(const SavedState& state, int64_t created);
    // The newest whole one of this log. Left out are those of a message that the log does not have, or has another of,
    // those that it does not go on from any more, and those of ticks after `last_tick`. Nothing: there is none, or it
    // is being replaced by another server just now. `changing`: true in the second case. Throws EngineAway.
    std::optional<SavedState> read(const Engine::LogInfo& log, uint64_t last_tick, bool& changing);

private:
    std::optional<Manifest> manifest(uint32_t slot);
    bool isOf(const Engine::LogInfo& log, const Manifest& snapshot) const;
    std::optional<SavedState> state(uint32_t slot, const Manifest& of);

    Engine& engine_;
};

// Of a message's text.
uint64_t hashOf(std::string_view text);

} // namespace brume::cluster

// Snapshots: states of a cluster's simulation in the engine, from which a server that joins goes on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/cluster/engine.h"
#include "server/cluster/handover.h"

namespace brume::cluster {

// What a snapshot says of itself.
struct Manifest {
    uint64_t tick = 0, hash = 0;
    uint64_t sequence = 0;            // of the last message of the log that is in it
    int64_t created = 0;              // Engine::LogInfo::created of that log
    uint64_t bytes = 0, checksum = 0; // of its parts together, XXH3
};

class Snapshots {
public:
    explicit Snapshots(Engine& engine) : engine_(engine) {}

    // Writes one in place of the older of the two, or of one that is no good. Returns its size in bytes. Throws
    // EngineAway.
    uint64_t write(const SavedState& state, int64_t created);
    // The newest whole one of this log. Those of a message after `last_sequence`, which the log does not have, and of
    // ticks after `last_tick` are left out. Nothing: there is none, or it is being replaced by another server just now.
    // `changing`: true in the second case. Throws EngineAway.
    std::optional<SavedState> read(int64_t created, uint64_t last_sequence, uint64_t last_tick, bool& changing);

private:
    std::optional<Manifest> manifest(uint32_t slot);
    std::optional<SavedState> state(uint32_t slot, const Manifest& of);

    Engine& engine_;
};

} // namespace brume::cluster

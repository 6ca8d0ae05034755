// What an operator may set of a cluster: several servers that simulate one scene by one log.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace brume::cluster {

// What ends a server of a cluster, or keeps it from joining. The text is one line that says what to do.
struct ClusterError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct EngineOptions {
    std::string servers;                    // URLs of NATS servers of one cluster, divided by commas; empty: no cluster
    std::filesystem::path credentials;      // NATS .creds; empty: those in the URLs, or none
    std::filesystem::path ca;               // PEM, whom to trust; empty: whom the system trusts
    std::filesystem::path certificate, key; // PEM, what this server shows; empty: nothing
    std::string log;                        // name of the log; letters, digits, '-' and '_'
    std::string room;                       // the room that has it, of the same letters; empty: the scene at "/"
    uint32_t replicas = 1;                  // NATS servers that keep the log
    uint64_t log_bytes = 1024ull << 20;     // most that the log keeps: two days of ticks
    std::chrono::milliseconds timeout{5000}; // for NATS to answer at the start
};

// The log's name for people.
inline std::string nameOf(const EngineOptions& options) {
    return options.room.empty() ? options.log : options.log + "/" + options.room;
}

struct ClusterOptions {
    EngineOptions engine;
    std::string url;         // where viewers reach this server; empty: none are sent here
    std::string hosts;       // besides the host of `url`: to which viewers may be sent, see Hosts
    uint32_t snapshot_s = 5; // seconds between snapshots of the state
    bool anew = false;       // True: deletes the log and its snapshots first
};

} // namespace brume::cluster

// Engine: the NATS servers that keep the log of a cluster and the snapshots of its state. The only part that knows
// NATS.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "server/cluster/options.h"

namespace brume::cluster {

// No answer came, or one that says to try again. What was asked for may have happened or not.
struct EngineAway : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct Stored {
    uint64_t sequence = 0; // place in the log, counted from 1
    std::string text;
};

class Engine {
public:
    // Connects. `wake` is called by another thread whenever take() may have something. Throws ClusterError.
    Engine(const EngineOptions& options, std::function<void()> wake);
    ~Engine();

    bool connected() const;
    // True: NATS does not let this server in any more, and it is not tried again.
    bool refused() const;
    // How often the connection was made. Another number than before: messages may have been lost meanwhile.
    uint64_t connections() const;

    struct LogInfo {
        int64_t created = 0;          // another one is another log
        uint64_t first = 0, last = 0; // sequences that are kept; last is 0 in a new log
        std::string about;
    };
    // Nothing: there is no log of that name. Throws EngineAway.
    std::optional<LogInfo> info() const;
    // The log, which is made with this description if there is none. Throws EngineAway, and ClusterError when it cannot
    // be made.
    LogInfo open(const std::string& about);
    // Deletes the log and all snapshots. Throws EngineAway.
    void forget();

    // Sends a message to the log. Whether it got there is seen when it comes back. False: it could not be sent.
    bool publish(std::string_view text);
    // From now on take() gives the messages from this sequence on; those that wait are forgotten.
    void follow(uint64_t from);
    // Moves what has come to the end of `out`. False: nothing has.
    bool take(std::vector<Stored>& out);
    // One message of the log. Nothing: it is not there any more. Throws EngineAway.
    std::optional<std::string> message(uint64_t sequence) const;

    // Values by key, of at most kMostBytes. Throw EngineAway.
    void put(const std::string& key, std::span<const std::byte> bytes);
    std::optional<std::vector<std::byte>> get(const std::string& key);

    static constexpr size_t kMostBytes = 512 << 10;

private:
    struct State;
    std::unique_ptr<State> state_;
};

// The servers without user names and passwords, for people to read.
std::string withoutSecrets(const std::string& servers);

} // namespace brume::cluster

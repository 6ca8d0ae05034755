// Log: what the messages of a cluster mean, in their order. Its state is a pure function of them: no clock, no
// connection, and it does not know which server it runs in. Every server computes the same.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/cluster/message.h"

namespace brume::cluster {

inline constexpr uint64_t kMostAdvance = 60;   // ticks: a larger step of one message is ignored
inline constexpr uint64_t kHereFor = 300;      // ticks: a server that said nothing for so long is gone
inline constexpr uint64_t kRemembered = 36000; // ticks: then its numbers of commands are forgotten, too
inline constexpr size_t kMostNodes = 256;      // of which the log keeps anything

class Log {
public:
    // Ticks first ... last. The first takes the commands, in order; the others take none.
    struct Step {
        uint64_t first = 0, last = 0;
        std::vector<NodeCommand> commands;
    };
    // Nothing: no tick follows from the message. An `Advance` to a tick that was there, or too far away, is ignored. So
    // is a command whose number is not the next one of its server: it came twice, or before one that was lost.
    std::optional<Step> take(LogMessage message);

    uint64_t tick() const { return tick_; }
    // Who published the last `Advance` that had an effect; empty: nobody did.
    const std::string& ticker() const { return ticker_; }
    // Number of the last command that was taken of this server; 0: none was.
    uint64_t lastNumber(const std::string& node) const;
    // The servers that are there, by name.
    std::vector<Here> present() const;
    // Who takes over first when ticks end: 0, then 1 and so on. Servers that are there count, but for the ticker. One
    // that is not there comes last.
    size_t rank(const std::string& node) const;

    // As text for a snapshot, and back. Throws StateError.
    std::string save() const;
    static Log load(std::string_view text);

private:
    struct Node {
        uint64_t number = 0; // of its last command
        uint64_t heard = 0;  // tick at which it said something
        std::optional<Here> here;
        uint64_t here_at = 0; // tick at which it said so
    };
    Node* node(const std::string& name);
    std::optional<Step> advance(const Advance& to);
    void forget();

    uint64_t tick_ = 0;
    std::string ticker_;
    std::deque<NodeCommand> waiting_; // for the next tick
    std::map<std::string, Node> nodes_;
};

} // namespace brume::cluster

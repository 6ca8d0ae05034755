// OwnCommands: what viewers of this server asked for, on its way to the log, back, and to the tick that takes it.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "server/cluster/message.h"
#include "server/viewer/frame.h"

namespace brume::cluster {

class OwnCommands {
public:
    using Time = Clock::time_point;

    OwnCommands();

    const std::string& name() const { return name_; } // of this server in the log
    // True: more may be published. With so many on their way, others wait in the viewers' queue.
    bool hasRoom() const { return unseen_.size() + waiting_.size() < kMost; }
    // Numbers a command. Returns the message to publish, which lives until the next call.
    const std::string& add(Command command, Time now);
    // A command of this server came back with this number. `taken`: Log::lastNumber() of this server after it. Where
    // the log did not take the first one that is waited for, it has forgotten this server, or lost what came before:
    // then this server goes on under another name, and overdue() gives all that is on its way.
    void came(uint64_t number, uint64_t taken, Time now);
    // Messages to be sent again, in their order. None: there is time.
    std::vector<std::string> overdue(Time now);
    // All that was published comes again, from a state of the log in which `taken` was the last of this server.
    void rejoined(uint64_t taken, Time now);
    // The command as this server knows it, for its tick: with its viewer, and when it came. Of a command of another
    // server the viewer is 0.
    Command take(NodeCommand&& command);

    uint64_t lost() const { return lost_; }     // that came back once and that the log does not know any more
    uint64_t resent() const { return resent_; } // messages

private:
    static constexpr size_t kMost = 64;
    static constexpr std::chrono::milliseconds kOverdue{1000};
    struct Own {
        uint64_t number = 0;
        Command command;
        std::string message;
    };
    void renew();

    std::string name_;
    uint64_t number_ = 0;     // of the last one
    std::deque<Own> unseen_;  // published, and not come back
    std::deque<Own> waiting_; // come back, and not taken by a tick
    Time sent_at_{};          // the first of unseen_, or later
    bool rejoined_ = false;   // True: what is missing was lost by the log, not forgotten
    bool all_again_ = false;  // True: all of unseen_ must be sent
    uint64_t lost_ = 0, resent_ = 0;
};

} // namespace brume::cluster

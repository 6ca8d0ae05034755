// A session that reconnects: after a lost connection to the same server, or to the next of several, as the page does
// (client/web/src/backoff.ts); and after a goodbye to the server that it names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/native/options.h"
#include "client/native/session.h"

namespace brume::client {

// Seconds to wait before the next try. Steps grow from 0.1 s to 1 s by doubling. The wait is half of the step to all
// of it, at random, so that the viewers of a server that restarts do not all come back in one instant. It is never
// shorter than the server asked for.
class Backoff {
public:
    // `asked_s`: the wait that the server asked for, or 0. `part`: a random number in [0, 1].
    double next(double asked_s, double part);
    void reset() { step_s_ = kFirstS; }

private:
    static constexpr double kFirstS = 0.1, kLongestS = 1;
    double step_s_ = kFirstS;
};

class Link {
public:
    // After a minute without a frame it gives up, since the server then forgets the viewer. With `for_ever` it goes
    // on trying, if it was welcomed at least once.
    Link(const Options& options, bool for_ever) : options_(options), for_ever_(for_ever), servers_(options.servers) {}

    // The session; connects again, as the same viewer, when it is time. Null until then.
    Session* session(const Wishes& wishes);
    // To be called for each frame, or while none is expected: the connection works.
    void heard(uint64_t now_us);
    // To be called when session() has no more messages. If it has closed or no frame came in time, plans the next try
    // and says so once on stderr. Throws std::runtime_error, one line, if there is to be none: the server never let
    // it in and does not say when to come again, it refuses what another try will not change, or --no-reconnect.
    // `last_error`: the server's last error, for that line.
    void check(const std::string& last_error);
    // Why there are no frames, in one line; empty while there are.
    const std::string& trouble() const { return trouble_; }
    // Says goodbye, if there is a session.
    void leave(const std::string& reason);

private:
    void lose(const std::string& why);
    bool goWhereSent();
    bool goToNext();

    const Options& options_;
    bool for_ever_;
    std::vector<Endpoint> servers_;   // those of the options, then one that a goodbye named
    size_t at_ = 0;                   // number of the server to try next
    size_t failed_ = 0, refused_ = 0; // sessions in a row that ended: without a frame since; by Session::refused()
    double asked_s_ = 0;              // the longest wait that servers asked for since they were last waited for
    std::optional<Session> session_;
    std::string key_; // Granted::resume of the last welcome
    std::string trouble_;
    bool welcomed_ = false; // true: a server has welcomed it at least once
    uint64_t connected_us_ = 0, next_try_us_ = 0;
    uint64_t heard_us_ = nowUs(); // when the newest frame came, or the start
    Backoff backoff_;
};

} // namespace brume::client

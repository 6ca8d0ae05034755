// The session of a viewer that comes back when its connection breaks, as the page does (client/web/src/backoff.ts), and goes
// where a server that stops sends it.
#pragma once

#include <optional>
#include <string>

#include "client/native/options.h"
#include "client/native/session.h"

namespace brume::client {

// Seconds before the next try: steps of 0.25 that double to 1, and of each half to all, so that the viewers of a server that
// restarts do not come back in one instant. A wait that the server asks for is not cut short.
class Backoff {
public:
    // `asked_s` is 0 when the server asked for nothing; `part` in [0, 1] is random.
    double next(double asked_s, double part);
    void reset() { step_s_ = kFirstS; }

private:
    static constexpr double kFirstS = 0.25, kLongestS = 1;
    double step_s_ = kFirstS;
};

class Link {
public:
    // A server keeps a lost viewer's place for a minute. After one without a frame this gives up, unless it has been in and is
    // to try `for_ever`.
    Link(const Options& options, bool for_ever) : options_(options), for_ever_(for_ever), server_(options.endpoint) {}

    // Connects when it is time, as who it was before. Null until then.
    Session* session(const Wishes& wishes);
    // A frame came: all is well.
    void heard(uint64_t now_us);
    // To be called when session() has no more messages. When it has ended or no frame came in time, plans the next try and says
    // so once on stderr; throws std::runtime_error, one line, when there is to be none: the server never let it in and does not
    // say when to come again, or refuses what another try will not change, or --no-reconnect. `last_error` is what the server
    // said.
    void mind(const std::string& last_error);
    // Why there are no frames, in one line; empty while there are.
    const std::string& trouble() const { return trouble_; }
    // Says goodbye, if there is a session.
    void leave(const std::string& reason);

private:
    void lose(const std::string& why);
    bool move();

    const Options& options_;
    bool for_ever_;
    Endpoint server_;               // the one to try
    std::optional<Endpoint> other_; // the one to try after it, when it does not let us in: of a goodbye's two ends
    std::optional<Session> session_;
    std::string key_; // of the last welcome
    std::string trouble_;
    bool been_in_ = false;
    uint64_t connected_us_ = 0, next_try_us_ = 0;
    uint64_t heard_us_ = nowUs(); // the newest frame, or the start
    Backoff backoff_;
};

} // namespace brume::client

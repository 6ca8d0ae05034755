// SIGHUP: what may change while the server runs.
#pragma once

#include "server/frame.h"
#include "server/net/server.h"
#include "server/options.h"

namespace brume {

struct Running {
    Audience& audience;
    FrameLoop& frames;
    NetServer& network;
};

// Reads flags, environment and file anew. Of what differs from `now`, live settings change and are logged as old -> new; the log
// names the others, which keep their values. A mistake changes nothing and is one line in the log.
void reload(ParsedOptions& now, int argc, const char* const* argv, const Running& running);

} // namespace brume

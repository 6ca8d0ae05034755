// reload(): applies changed options while the server runs (SIGHUP).
#pragma once

#include "server/net/server.h"
#include "server/options/options.h"
#include "server/room_keeper.h"

namespace brume {

// Parts of the running server that options change.
struct Running {
    ServedRoom& home; // which shows no replay
    RoomKeeper& rooms;
    NetServer& network;
};

// Reads flags, environment and file again. Live settings that differ from `now` change and are logged as old -> new.
// Other settings that differ keep their values, and the log names them. A mistake changes nothing and is logged in
// one line. A scene whose files have changed is loaded again.
void reload(ParsedOptions& now, int argc, const char* const* argv, const Running& running);

} // namespace brume

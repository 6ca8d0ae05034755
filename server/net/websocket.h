// One viewer over a WebSocket that speaks brume.v1.
#pragma once

#include <memory>

#include "protocol/net/byte_stream.h"
#include "server/net/access.h"
#include "server/net/context.h"
#include "server/net/request_check.h"

namespace brume::net {

// Answers the upgrade and serves the session on the stream's executor. Returns at once. Precondition: the request asks
// for a WebSocket and for brume.v1 in this room, and `authorization` is its own.
void serveWebSocket(std::shared_ptr<const Context> context, RoomPtr room, ByteStream stream, const HttpRequest& request,
                    std::unique_ptr<ConnectionSlot> slot, Authorization authorization);

} // namespace brume::net

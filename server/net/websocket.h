// One viewer over a WebSocket: brume.v1.
#pragma once

#include <memory>
#include <string_view>

#include "common/byte_stream.h"
#include "server/net/access.h"
#include "server/net/context.h"
#include "server/net/request_check.h"

namespace brume::net {

// Answers the upgrade and carries on from there. Precondition: the request asks for a WebSocket and for brume.v1, and
// was cleared.
void serveWebSocket(Context& context, ByteStream stream, const HttpRequest& request, std::unique_ptr<Connections::Place> place,
                    Clearance clearance);

} // namespace brume::net

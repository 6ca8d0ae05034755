// One HTTP connection: requests until it ends or becomes a WebSocket.
#pragma once

#include <memory>

#include "common/byte_stream.h"
#include "server/net/context.h"

namespace brume::net {

// Shakes hands first where the stream has TLS. Precondition: its executor is a strand of its own. Returns at once.
void serveHttp(Context& context, ByteStream stream, std::unique_ptr<Connections::Place> place);

} // namespace brume::net

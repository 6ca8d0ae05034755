// One HTTP connection: requests until it ends or becomes a WebSocket.
#pragma once

#include <memory>

#include "protocol/net/byte_stream.h"
#include "server/net/context.h"
#include "server/net/reply.h"

namespace brume::net {

// Serves the connection on the stream's executor, which must be a strand of its own, and begins with the TLS handshake
// if the stream has TLS. Returns at once.
void serveHttp(std::shared_ptr<const Context> context, ByteStream stream, std::unique_ptr<ConnectionSlot> slot);

// The bytes of a reply after which the connection ends.
std::string lastWords(Reply reply, const NetOptions& options);

} // namespace brume::net

// A connection through a gateway, before it is known whose it is.
#pragma once

#include <memory>

#include "protocol/net/byte_stream.h"
#include "server/net/address.h"
#include "server/net/context.h"

namespace brume::net {

// Serves a connection that comes from this address.
using ServeFrom = void (*)(std::shared_ptr<const Context> context, ByteStream::Tcp tcp, const Address& address);

// Reads the PROXY protocol header on the stream's executor, which must be a strand of its own, and calls `serve` there
// with the address in it, or with `own` where the gateway speaks for itself. Ends the connection, and logs one line, if
// the header is wrong or takes longer than NetOptions::handshake. `slot`: of Connections::takeOwing(). Returns at once.
void greetGateway(std::shared_ptr<const Context> context, ByteStream::Tcp tcp, std::unique_ptr<ConnectionSlot> slot,
                  const Address& own, ServeFrom serve);

} // namespace brume::net

// One HTTP connection: requests until it ends or becomes a WebSocket.
#pragma once

#include <memory>

#include <boost/asio/ip/tcp.hpp>

#include "server/net/context.h"

namespace brume::net {

// Precondition: the socket's executor is a strand of its own. Returns at once.
void serveHttp(Context& context, boost::asio::ip::tcp::socket socket, std::unique_ptr<Connections::Place> place);

} // namespace brume::net

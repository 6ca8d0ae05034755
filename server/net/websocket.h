// One viewer over a WebSocket: brume.v1.
#pragma once

#include <memory>
#include <string_view>

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "common/byte_stream.h"
#include "server/net/access.h"
#include "server/net/context.h"

namespace brume::net {

using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;

// Answers the upgrade and carries on from there. Precondition: the request asks for a WebSocket and for brume.v1, and
// was cleared.
void serveWebSocket(Context& context, ByteStream stream, const HttpRequest& request, std::unique_ptr<Connections::Place> place,
                    Clearance clearance);

} // namespace brume::net

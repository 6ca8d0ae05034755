// What is wrong with an HTTP request before any route answers it.
#pragma once

#include <optional>

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>

#include "server/net/options.h"
#include "server/net/origin.h"
#include "server/net/reply.h"

namespace brume::net {

using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;
using RequestParser = boost::beast::http::request_parser<boost::beast::http::empty_body>;

// Bytes of a body that nothing reads: some programs send a few with every POST.
inline constexpr uint64_t kMostUnusedBody = 4096;

// What the request says of the page that made it.
Asker askerOf(const HttpRequest& request);

// The refusal of a body that is longer than NetOptions::max_upload.
Reply tooLarge(const NetOptions& options);

// The refusal of what is no request or of a kind that is not served here; `error` is that of reading its header. Empty
// for a good request, and for a connection that is gone.
std::optional<Reply> unfit(const boost::system::error_code& error, const RequestParser& parser,
                           const NetOptions& options);

// The refusal of a request that another site's page may have made a visitor's browser send (origin.h).
struct Foreign {
    Reply reply;
    const char* reason; // for Metrics::refused
    std::string line;   // for the log; empty: none
};
// `guarded`: true for routes that cost device time or reveal something. Precondition: unfit() found nothing.
std::optional<Foreign> foreign(const HttpRequest& request, bool guarded, const NetOptions& options);

} // namespace brume::net

#include "server/net/request_check.h"

#include <fmt/format.h>

#include "common/text.h"
#include "server/net/pages.h"
#include "server/net/routes.h"

namespace brume::net {

namespace beast = boost::beast;
namespace http = beast::http;

namespace {

constexpr char kNoUploads[] = "this server takes no uploads: --max-upload allows them";
constexpr size_t kLongestOrigin = 200; // as it is told

std::string_view valueOf(const HttpRequest& request, http::field name) {
    const auto value = request[name];
    return {value.data(), value.size()};
}

} // namespace

Asker askerOf(const HttpRequest& request) {
    const auto site = request["Sec-Fetch-Site"];
    return {.host = valueOf(request, http::field::host),
            .origin = valueOf(request, http::field::origin),
            .referer = valueOf(request, http::field::referer),
            .site = {site.data(), site.size()}};
}

Reply tooLarge(const NetOptions& options) {
    Reply reply = lineReply(413, options.max_upload == 0
                                     ? kNoUploads
                                     : fmt::format("the file is over {} MiB: --max-upload", options.max_upload >> 20));
    reply.close = true;
    return reply;
}

std::optional<Reply> unfit(const boost::system::error_code& error, const RequestParser& parser,
                           const NetOptions& options) {
    const auto refuse = [](unsigned status, std::string line) {
        Reply reply = lineReply(status, std::move(line));
        reply.close = true; // it is unknown where the next request would begin
        return reply;
    };
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
        const bool in_first_line = parser.get().target().empty();
        return in_first_line
                   ? refuse(414, fmt::format("the path and query are over {} bytes", options.max_target_bytes))
                   : refuse(431, fmt::format("the request's header is over {} bytes", options.max_header_bytes));
    }
    if (error == http::error::body_limit) return tooLarge(options);
    if (error == http::error::end_of_stream || error == http::error::partial_message) return {};
    if (error.category() == http::make_error_code(http::error::bad_method).category())
        return refuse(400, fmt::format("not an HTTP request: {}", error.message()));
    if (error) return {};
    const auto& request = parser.get();
    if (request.target().size() > options.max_target_bytes)
        return refuse(414, fmt::format("the path and query are over {} bytes", options.max_target_bytes));
    if (!request.target().starts_with('/')) return refuse(400, "the path must begin with /");
    const std::string_view target(request.target().data(), request.target().size());
    const Route* const route = routeOf(target.substr(0, target.find('?')));
    const auto method = request.method_string();
    const std::string_view named(method.data(), method.size());
    const bool read = named == "GET" || named == "HEAD", asks = named == "OPTIONS";
    if (!read && !asks && !route) {
        Reply reply = noSuchPage();
        reply.close = true;
        return reply;
    }
    if (route && !asks && !route->takes(named)) {
        Reply reply = refuse(405, fmt::format("only {} is served here", route->methods));
        reply.headers = {{"Allow", std::string(route->methods)}};
        return reply;
    }
    const uint64_t length = parser.content_length().value_or(0);
    if (route && route->takes_file && !asks) {
        if (options.max_upload == 0) return refuse(413, kNoUploads);
    } else if (parser.chunked() || length > (named == "POST" ? kMostUnusedBody : 0)) {
        return refuse(413, "a request here has no body");
    }
    // RFC 9112, 3.2. A request of HTTP/1.0 may have none: it comes from a simple health check, not from a browser.
    const size_t hosts = request.count(http::field::host);
    if (hosts > 1 || (hosts == 0 && request.version() >= 11)) return refuse(400, "a request has one Host header");
    if (request.count(http::field::origin) > 1) return refuse(400, "a request has one Origin header");
    // RFC 9112, 6.1: other codings than chunked are not known here.
    if (const auto coding = request[http::field::transfer_encoding];
        !coding.empty() && !beast::iequals(coding, "chunked"))
        return refuse(501, "allowed: Transfer-Encoding: chunked, or none");
    return {};
}

std::optional<Foreign> foreign(const HttpRequest& request, bool guarded, const NetOptions& options) {
    const bool named = request.count(http::field::host) > 0;
    if (options.token_key.empty() && named && !hostAllowed(valueOf(request, http::field::host), options))
        return Foreign{
            lineReply(421, "this host name is not served: use the server's IP address, or allow the name with --host"),
            "host",
            {}};
    const Asker asker = askerOf(request);
    if (!guarded || pageAllowed(asker, options.allowed_origins)) return {};
    const std::string page =
        oneLine(std::string((asker.origin.empty() ? asker.referer : asker.origin).substr(0, kLongestOrigin)));
    const std::string cure = page.empty() ? "" : " " + page;
    Reply reply = lineReply(403, fmt::format("pages of another site may not ask for this: start the server with "
                                             "--allow-origin{} or, behind a proxy, have it pass the Host header on",
                                             cure));
    // The page may read why.
    reply.headers = {{"Brume-Refused", "origin"},
                     {"Access-Control-Allow-Origin", "*"},
                     {"Access-Control-Expose-Headers", "Brume-Refused"}};
    return Foreign{
        std::move(reply), "origin",
        fmt::format("a page of {} was refused; it asked for host {}. --allow-origin allows it; a proxy in between must "
                    "pass the Host header on",
                    page.empty() ? "another site" : page, oneLine(std::string(asker.host.substr(0, kLongestOrigin))))};
}

} // namespace brume::net

#include "server/net/request_check.h"

#include <fmt/format.h>

#include "server/net/origin.h"
#include "server/net/pages.h"

namespace brume::net {

namespace http = boost::beast::http;

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
    if (error == http::error::body_limit)
        return refuse(413, options.max_upload == 0
                               ? "this server takes no uploads: --max-upload allows them"
                               : fmt::format("the file is over {} MiB: --max-upload", options.max_upload >> 20));
    if (error == http::error::end_of_stream || error == http::error::partial_message) return {};
    if (error.category() == http::make_error_code(http::error::bad_method).category())
        return refuse(400, fmt::format("not an HTTP request: {}", error.message()));
    if (error) return {};
    const auto& request = parser.get();
    if (request.target().size() > options.max_target_bytes)
        return refuse(414, fmt::format("the path and query are over {} bytes", options.max_target_bytes));
    if (!request.target().starts_with('/')) return refuse(400, "the path must begin with /");
    const std::string_view target(request.target().data(), request.target().size());
    const std::string_view path = target.substr(0, target.find('?'));
    const bool posted = request.method() == http::verb::post, points = path == "/cloud";
    const bool changes = path == "/pause" || path == "/resume" || path == "/seek" || path == "/scene" || points;
    const bool read = request.method() == http::verb::get || request.method() == http::verb::head;
    if (!read && !isAddress(path)) {
        Reply reply = noSuchPage();
        reply.close = true;
        return reply;
    }
    if (changes ? !posted : !read) {
        Reply reply = refuse(405, changes ? "only POST is served here" : "only GET and HEAD are served here");
        reply.headers = {{"Allow", changes ? "POST" : "GET, HEAD"}};
        return reply;
    }
    if (points && !parser.content_length()) return refuse(411, "the file's length is needed: Content-Length");
    if (!points && (parser.chunked() || parser.content_length().value_or(0) > 0))
        return refuse(413, "a request here has no body");
    // RFC 9112, 3.2. A request of HTTP/1.0 may have none: it comes from a simple health check, not from a browser.
    const size_t hosts = request.count(http::field::host);
    if (hosts > 1 || (hosts == 0 && request.version() >= 11)) return refuse(400, "a request has one Host header");
    return {};
}

std::optional<Foreign> foreign(const HttpRequest& request, bool guarded, const NetOptions& options) {
    const auto field = [&](http::field name) {
        const auto value = request[name];
        return std::string_view(value.data(), value.size());
    };
    const bool named = request.count(http::field::host) > 0;
    if (options.token_key.empty() && named && !hostAllowed(field(http::field::host), options))
        return Foreign{
            lineReply(421, "this host name is not served: use the server's IP address, or allow the name with --host"),
            "host"};
    const auto site = request["Sec-Fetch-Site"];
    if (guarded && !siteAllowed({site.data(), site.size()}, field(http::field::origin), field(http::field::referer),
                                options.allowed_origins))
        return Foreign{
            lineReply(403, "a page of another site may not ask for this: allow its origin with --allow-origin"),
            "cross_site"};
    return {};
}

} // namespace brume::net

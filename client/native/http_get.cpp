#include "client/native/http_get.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <fmt/format.h>

#include "client/native/tls.h"
#include "common/text.h"
#include "protocol/net/byte_stream.h"

namespace brume::client {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr size_t kLongestShown = 200; // bytes of an answer's text

struct Get {
    const Endpoint& server;
    asio::io_context io{1};
    tcp::resolver resolver{io};
    TlsContexts tls; // outlives the stream
    std::optional<ByteStream> stream;
    http::request<http::empty_body> request;
    beast::flat_buffer buffer;
    http::response_parser<http::string_body> answer;
    std::string problem = "no answer in time";

    Get(const Endpoint& from, const std::string& path, uint64_t most)
        : server(from), request(http::verb::get, path, 11) {
        answer.body_limit(most);
        request.set(http::field::host, server.authority());
        request.set(http::field::connection, "close");
        if (!server.token.empty()) request.set(http::field::authorization, "Bearer " + server.token);
        server.tls ? stream.emplace(beast::tcp_stream(io), tls.of(server.ca)) : stream.emplace(beast::tcp_stream(io));
    }

    // Each step starts the next; the last problem, or none, stays.
    void start() {
        resolver.async_resolve(server.host, std::to_string(server.port),
                               [this](error_code error, const tcp::resolver::results_type& found) {
                                   if (failed(error, " (is the host's name right?)")) return;
                                   stream->tcp().async_connect(found, [this](error_code e, const tcp::endpoint&) {
                                       if (failed(e, " (is the server running there?)")) return;
                                       stream->tls() ? secure() : ask();
                                   });
                               });
    }
    void secure() {
        if (!(problem = expectHost(*stream->tls(), server.host)).empty()) return;
        stream->tls()->async_handshake(asio::ssl::stream_base::client, [this](error_code error) {
            if (error)
                problem = tlsFault(*stream->tls(), error, error.message()) + " (is it TLS there? --ca)";
            else
                ask();
        });
    }
    void ask() {
        http::async_write(*stream, request, [this](error_code error, size_t) {
            if (failed(error, "")) return;
            http::async_read(*stream, buffer, answer, [this](error_code last, size_t) { failed(last, ""); });
        });
    }
    bool failed(error_code error, const char* question) {
        problem = !error                             ? ""
                  : error == http::error::body_limit ? "its answer is too long"
                                                     : error.message() + question;
        return bool(error);
    }
};

// A server of brume says in one line why it refuses.
std::string refusalOf(const http::response<http::string_body>& answer) {
    const unsigned status = answer.result_int();
    std::string why = fmt::format("it answers HTTP {} {}", status, std::string(answer.reason()));
    const std::string& body = answer.body();
    const std::string line = body.substr(0, std::min(body.find_first_of("\r\n"), kLongestShown));
    if (answer[http::field::content_type].starts_with("text/plain") && !line.empty()) why += ": " + line;
    return why + (status == 401 || status == 403 ? " (--token-file)" : "");
}

} // namespace

std::string httpGet(const Endpoint& server, const std::string& path, std::chrono::milliseconds timeout, uint64_t most) {
    Get get(server, path, most);
    get.start();
    get.io.run_for(timeout);
    if (get.problem.empty() && get.answer.get().result() != http::status::ok) get.problem = refusalOf(get.answer.get());
    if (!get.io.stopped()) get.problem = "no answer in time";
    if (!get.problem.empty()) throw std::runtime_error(oneLine(get.problem));
    return std::move(get.answer.get().body());
}

} // namespace brume::client

// The only file here that sees Beast, which is slow to compile.
#include "client/load/scrape.h"

#include <cmath>
#include <cstdlib>
#include <optional>
#include <stdexcept>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include "client/native/tls.h"

namespace brume::load {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;

struct Get {
    asio::io_context io{1};
    tcp::resolver resolver{io};
    client::TlsContexts tls; // outlives the stream
    std::optional<ByteStream> stream;
    http::request<http::empty_body> request{http::verb::get, "/metrics", 11};
    beast::flat_buffer buffer;
    http::response<http::string_body> response;
    error_code failure = beast::error::timeout;

    // Each step starts the next; the last failure, or none, stays.
    void start(const client::Endpoint& server) {
        request.set(http::field::host, server.host + ":" + std::to_string(server.port));
        request.set(http::field::connection, "close");
        if (!server.token.empty()) request.set(http::field::authorization, "Bearer " + server.token);
        server.tls ? stream.emplace(beast::tcp_stream(io), tls.of(server.ca)) : stream.emplace(beast::tcp_stream(io));
        if (server.tls) (void)client::expectHost(*stream->tls(), server.host);
        resolver.async_resolve(server.host, std::to_string(server.port),
                               [this](error_code error, const tcp::resolver::results_type& found) {
                                   if ((failure = error)) return;
                                   stream->tcp().async_connect(
                                       found, [this](error_code e, const tcp::endpoint&) { connected(e); });
                               });
    }
    void connected(error_code error) {
        if ((failure = error)) return;
        if (!stream->tls()) return ask();
        stream->tls()->async_handshake(asio::ssl::stream_base::client, [this](error_code e) {
            if (!(failure = e)) ask();
        });
    }
    void ask() {
        http::async_write(*stream, request, [this](error_code e, size_t) {
            if ((failure = e)) return;
            http::async_read(*stream, buffer, response, [this](error_code last, size_t) { failure = last; });
        });
    }
};

} // namespace

Series parseSeries(std::string_view text) {
    Series all;
    while (!text.empty()) {
        const size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        // A label's text may have spaces: the name ends with its brace when it has one.
        const size_t brace = line.rfind('}'), space = line.find(' ', brace == line.npos ? 0 : brace);
        if (line.empty() || line[0] == '#' || space == line.npos) continue;
        const std::string number(line.substr(space + 1)); // a time may follow it
        char* parsed = nullptr;
        const double value = std::strtod(number.c_str(), &parsed);
        if (parsed != number.c_str()) all.emplace(line.substr(0, space), value);
    }
    return all;
}

Series scrape(const client::Endpoint& server, std::chrono::milliseconds timeout) {
    Get get;
    get.start(server);
    get.io.run_for(timeout);
    const auto refuse = [](const std::string& why) { throw std::runtime_error("/metrics cannot be read: " + why); };
    if (!get.io.stopped()) refuse("no answer in time");
    if (get.failure) refuse(get.failure.message());
    if (get.response.result() != http::status::ok) refuse("HTTP " + std::to_string(get.response.result_int()));
    return parseSeries(get.response.body());
}

} // namespace brume::load

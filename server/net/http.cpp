#include "server/net/http.h"

#include <algorithm>

#include <boost/asio/write.hpp>
#include <boost/beast/core/detect_ssl.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <fmt/format.h>

#include "protocol/message.h"
#include "server/net/http_connection.h"
#include "server/net/routes.h"
#include "server/net/viewers.h"
#include "server/net/websocket.h"

namespace brume::net {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;

constexpr auto kPreflightHolds = std::chrono::minutes(10);
constexpr char kOwnHeaders[] = "Brume-Tick, Brume-State, Brume-Size, Brume-Asked, Brume-Error, Brume-Ignored";
constexpr auto kAppliedWithin = std::chrono::seconds(2); // a command of HTTP
constexpr std::chrono::milliseconds kReservedTime{1000}; // for the header of a request on a reserved connection
constexpr auto kLinger = std::chrono::seconds(1); // for the peer to read the last answer before the socket closes

std::string_view pathOf(const HttpRequest& request) {
    const std::string_view target(request.target().data(), request.target().size());
    return target.substr(0, target.find('?'));
}

// The page of a room is at a path that ends with "/": its files are beside it.
Reply withSlash(std::string_view room, std::string_view query) {
    Reply reply = lineReply(308, "the room's page is at this path with / at its end");
    reply.headers = {{"Location", fmt::format("{}/{}{}", room, query.empty() ? "" : "?", query)}};
    return reply;
}

Reply noSuchRoom() {
    Reply reply = lineReply(404, "there is no such room: see /rooms");
    reply.headers = {{"Brume-Refused", "room"}};
    return reply;
}

constexpr char kUpgradeLost[] = "the proxy in front of this server does not pass WebSockets on: see docs/deploy.md";

// True for a WebSocket's handshake that a proxy has passed on as a plain request: without the headers that belong to
// one connection alone (RFC 9110, 7.6.1), with those that do not.
bool lostItsUpgrade(const HttpRequest& request) {
    return request.count(http::field::sec_websocket_key) > 0 && !beast::websocket::is_upgrade(request);
}

// What a browser asks before it lets a page of another origin ask: the methods of this path.
Reply preflight(const Route* route) {
    const std::string methods(route ? route->methods : "GET, HEAD");
    Reply reply;
    reply.status = 204;
    reply.headers = {{"Allow", methods + ", OPTIONS"},
                     {"Access-Control-Allow-Methods", methods},
                     {"Access-Control-Allow-Headers", "Authorization, Content-Type"},
                     {"Access-Control-Max-Age", fmt::format("{}", std::chrono::seconds(kPreflightHolds).count())}};
    return reply;
}

} // namespace

// The status line and the headers, without Content-Length and the empty line at the end.
std::string headOf(const Reply& reply, std::string_view connection, const NetOptions& options) {
    const beast::string_view reason = http::obsolete_reason(http::status(reply.status));
    std::string head =
        fmt::format("HTTP/1.1 {} {}\r\nServer: brume/{}\r\nConnection: {}\r\nContent-Type: {}\r\n"
                    "X-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: {}\r\n",
                    reply.status, std::string_view(reason.data(), reason.size()), BRUME_VERSION, connection,
                    reply.content_type, reply.for_all ? "cross-origin" : resourcePolicy(options));
    for (const auto& [name, value] : reply.headers) head += fmt::format("{}: {}\r\n", name, value);
    return head;
}

std::string lastWords(Reply reply, const NetOptions& options) {
    return fmt::format("{}Content-Length: {}\r\n\r\n{}", headOf(reply, "close", options), reply.body.size(),
                       reply.body);
}

asio::awaitable<void> HttpConnection::run() {
    const NetOptions& options = context_->options;
    const bool secured = co_await secure();
    if (!secured) co_return;
    for (bool first = true; !context_->stopping; first = false) {
        const bool begun = first || buffer_.size() > 0 || co_await another();
        if (!begun) co_return;
        RequestParser parser;
        parser.header_limit(options.max_header_bytes);
        parser.body_limit(std::max(options.max_upload, kMostUnusedBody));
        stream_.tcp().expires_after(headerTime());
        idle_ = true;
        const auto [error, size] = co_await http::async_read_header(stream_, buffer_, parser, kToken);
        idle_ = false;
        if (auto refusal = unfit(error, parser, options)) {
            co_await send(parser.get(), "refused", *std::move(refusal));
            break;
        }
        if (error) co_return; // the connection was closed or reset, or no request came in time
        unread_ = parser.chunked() || parser.content_length().value_or(0) > 0;
        const Route* const route = routeOf(pathOf(parser.get()));
        if (unread_ && !(route && route->takes_file)) {
            const bool dropped = co_await drop(parser.content_length().value_or(0));
            if (!dropped) co_return;
        }
        const bool goes_on = co_await answer(parser);
        room_ = context_->rooms.home(); // a room that nobody asks for any more can be closed
        if (!goes_on) break;
        if (slot_->forOthers()) slot_->passBack();
    }
    if (slot_) co_await linger();
}

// How long a TLS handshake, and then a request's header, may take.
Clock::duration HttpConnection::headerTime() const {
    const auto most = context_->options.handshake;
    return slot_->reserved() ? std::min(most, kReservedTime) : most;
}

// Waits for the first bytes of another request. False if none come in time, or the connection is gone.
asio::awaitable<bool> HttpConnection::another() {
    constexpr size_t kSome = 1024;
    stream_.tcp().expires_after(context_->options.keep_alive);
    idle_ = true;
    const auto [error, size] = co_await stream_.async_read_some(buffer_.prepare(kSome), kToken);
    idle_ = false;
    buffer_.commit(size);
    co_return !error;
}

// The TLS handshake, if the server has TLS. False if it failed; a peer that speaks plain HTTP is told.
asio::awaitable<bool> HttpConnection::secure() {
    ByteStream::Tls* const tls = stream_.tls();
    if (!tls) co_return true;
    idle_ = true;
    stream_.tcp().expires_after(headerTime());
    auto [error, is_tls] = co_await beast::async_detect_ssl(stream_.tcp(), buffer_, kToken);
    if (!error && !is_tls) {
        const std::string words = lastWords(
            lineReply(400, "this port speaks TLS: the address begins with https:// or wss://"), context_->options);
        co_await asio::async_write(stream_.tcp(), asio::buffer(words), kToken);
        co_await lingerOpenly();
        error = boost::system::errc::make_error_code(boost::system::errc::protocol_error);
    }
    if (!error) {
        const auto [refused, used] =
            co_await tls->async_handshake(asio::ssl::stream_base::server, buffer_.data(), kToken);
        buffer_.consume(used);
        error = refused;
    }
    idle_ = false;
    if (error && !context_->stopping) {
        context_->metrics.refused("tls");
        context_->log.write(spdlog::level::debug, slot_->network(),
                            fmt::format("{}: no TLS: {}", slot_->address(), error.message()));
    }
    co_return !error;
}

// True when another request may follow.
asio::awaitable<bool> HttpConnection::answer(RequestParser& parser) {
    const HttpRequest& request = parser.get();
    const std::string_view target(request.target().data(), request.target().size());
    const std::string_view whole = pathOf(request), query = target.substr(std::min(whole.size() + 1, target.size()));
    const RoomPath in = roomPathOf(whole);
    const std::string_view path = in.path;
    if (auto refusal = receive(request)) return send(request, "refused", *std::move(refusal));
    const Route* const route = routeOf(whole);
    if (path == "/ws" && lostItsUpgrade(request)) {
        context_->metrics.refused("upgrade");
        context_->log.write(spdlog::level::warn, slot_->network(),
                            fmt::format("{}: {}", slot_->address(), kUpgradeLost));
    }
    const Role* const least = route && route->least ? &*route->least : nullptr; // null: it shows nothing of the scene
    if (auto stranger = foreign(request, least != nullptr, context_->options)) {
        context_->metrics.refused(stranger->reason);
        if (!stranger->line.empty())
            context_->log.write(spdlog::level::warn, slot_->network(),
                                fmt::format("{}: {}", slot_->address(), stranger->line));
        return send(request, "refused", std::move(stranger->reply));
    }
    if (request.method() == http::verb::options) return send(request, "preflight", preflight(route));
    if (RoomPtr room = context_->rooms.find(in.room))
        room_ = std::move(room);
    else
        return send(request, "refused", noSuchRoom());
    if (path.empty()) return send(request, "page", withSlash(in.room, query));
    const bool health_check = path == "/healthz" || path == "/readyz";
    // A connection of the reserve is for health checks and for requests with a good token whose reply ends.
    const bool endless = path == "/ws" || path == "/stream.mjpg";
    if (slot_->reserved() && !health_check && (!least || endless || context_->options.token_key.empty())) {
        context_->metrics.refused("connections");
        return send(request, "refused", noRoom());
    }
    if (least) {
        const auto bearer = request[http::field::authorization];
        auto checked = authorize({bearer.data(), bearer.size()}, query, *least, context_->options, in.room);
        if (auto* refusal = std::get_if<Reply>(&checked)) {
            context_->metrics.refused(refusal->status == 401 ? "token" : "forbidden");
            return send(request, "refused", std::move(*refusal));
        }
        auto& authorization = std::get<Authorization>(checked);
        if (path == "/ws") return upgrade(request, std::move(authorization));
        if (path == "/snapshot.jpg" || path == "/snapshot.png" || path == "/snapshot.exr")
            return snapshot(request, path.substr(path.find('.') + 1), query, std::move(authorization));
        if (path == "/stream.mjpg") return stream(request, query, std::move(authorization));
        if (path == "/scene") return showScene(request, query);
        if (path == "/cloud") return showCloud(parser, query, std::move(authorization));
        if (path == "/scene.toml") return send(request, "scene", sceneFile(query));
        if (path == "/particles.ply") return particles(request);
        if (path == "/seek") return seek(request, query);
        if (path == "/rooms/open" || path == "/rooms/close") return changeRooms(request, path, query);
        if (path == "/pause" || path == "/resume") return pause(request, path == "/pause");
    }
    if (health_check || least) return send(request, path.substr(1), health(path));
    const auto tag = request[http::field::if_none_match];
    return send(request, "page",
                context_->pages.serve(path, {tag.data(), tag.size()}, context_->options.allowed_origins));
}

Reply HttpConnection::health(std::string_view path) const {
    Reply reply;
    if (path == "/healthz")
        reply = lineReply(200, "ok");
    else if (path == "/metrics") {
        reply.content_type = "text/plain; version=0.0.4; charset=utf-8";
        reply.body = metricsText();
    } else if (path == "/viewers") {
        reply.content_type = "application/json";
        reply.body = viewersJson(room_->audience);
    } else if (path == "/rooms") {
        reply.content_type = "application/json";
        reply.body = roomsJson(context_->rooms);
    } else if (context_->stopping)
        reply = lineReply(503, "not ready: the server stops");
    else if (context_->draining)
        reply = lineReply(503, "not ready: the server drains and will stop");
    else if (!room_->audience.ready)
        reply = lineReply(503, "not ready: no frame can be rendered yet, or the shared state is not caught up with");
    else
        reply = lineReply(200, "ready");
    reply.for_all = path == "/healthz" || path == "/readyz"; // a page asks another server if it is there
    reply.headers = {{"Cache-Control", "no-store"}};
    return reply;
}

// Pauses the scene for everybody, or lets it go on. The reply comes once that is so, with the tick and the state.
asio::awaitable<bool> HttpConnection::pause(const HttpRequest& request, bool on) {
    const SceneSetting* const setting = liveSetting("simulation.paused");
    const size_t at = size_t(std::ranges::find(liveSettings(), setting) - liveSettings().begin());
    if (ReplayControl* const replay = room_->audience.replay())
        replay->paused = on;
    else if (const CommandBody set = Set{{setting->path, on}}; !room_->audience.commands().push({.body = set}))
        co_return co_await sendLater(request, "pause", whyRefused(room_->audience.commands(), set));
    const auto deadline = Clock::now() + kAppliedWithin;
    std::shared_ptr<const SceneReport> report = room_->audience.report();
    while (report->settings[at] != SettingValue(on) && Clock::now() < deadline && !context_->stopping) {
        co_await event_->wait(std::min(deadline, Clock::now() + std::chrono::milliseconds(5)));
        report = room_->audience.report();
    }
    if (report->settings[at] != SettingValue(on))
        co_return co_await sendLater(request, "pause", "the server takes no commands just now: try again");
    Reply reply = lineReply(200, on ? "paused" : "running");
    reply.headers = {{"Brume-Tick", fmt::format("{}", report->tick)},
                     {"Brume-State", fmt::format("{:016x}", report->state_hash)},
                     {"Cache-Control", "no-store"}};
    co_return co_await send(request, "pause", std::move(reply));
}

// Makes the connection a WebSocket, or answers with one line that says why not.
asio::awaitable<bool> HttpConnection::upgrade(const HttpRequest& request, Authorization authorization) {
    Reply refusal;
    if (!beast::websocket::is_upgrade(request)) {
        refusal =
            lineReply(426, lostItsUpgrade(request) ? kUpgradeLost
                                                   : "this is a WebSocket: connect with ws://, subprotocol brume.v1");
        refusal.headers = {{"Upgrade", "websocket"}};
    } else if (!http::token_list(request[http::field::sec_websocket_protocol]).exists(wire::kSubprotocol)) {
        refusal = lineReply(400, "the WebSocket subprotocol brume.v1 is needed");
    } else {
        serveWebSocket(context_, room_, std::move(stream_), request, std::move(slot_), std::move(authorization));
        co_return false;
    }
    co_return co_await send(request, "ws", std::move(refusal));
}

// Header and body are two buffers, written together.
asio::awaitable<bool> HttpConnection::send(const HttpRequest& request, std::string_view route, Reply reply) {
    context_->metrics.requested(route, reply.status);
    const bool keeps_alive =
        request.keep_alive() && !reply.close && !unread_ && !slot_->reserved() && !context_->stopping;
    share(request, reply);
    std::string head = headOf(reply, keeps_alive ? "keep-alive" : "close", context_->options);
    if (reply.status != 304 && reply.status != 204) head += fmt::format("Content-Length: {}\r\n", reply.body.size());
    head += "\r\n";
    if (request.method() == http::verb::head) reply.body.clear();
    const Parts parts{asio::buffer(head), asio::buffer(reply.body)};
    const error_code error = co_await write(parts);
    co_return !error && keeps_alive;
}

// Adds what lets the browser give the reply to a page of an allowed origin.
void HttpConnection::share(const HttpRequest& request, Reply& reply) const {
    const auto origin = sharedWith(askerOf(request).origin, context_->options.allowed_origins);
    if (!origin) return;
    reply.headers.emplace_back("Access-Control-Allow-Origin", *origin);
    reply.headers.emplace_back("Access-Control-Expose-Headers", kOwnHeaders);
    reply.headers.emplace_back("Vary", "Origin");
}

// Passes over a short body that nothing reads. False if it did not come.
asio::awaitable<bool> HttpConnection::drop(uint64_t bytes) {
    stream_.tcp().expires_after(headerTime());
    while (buffer_.size() < bytes) {
        const auto [error, size] = co_await stream_.async_read_some(buffer_.prepare(kMostUnusedBody), kToken);
        if (error) co_return false;
        buffer_.commit(size);
    }
    buffer_.consume(bytes);
    unread_ = false;
    co_return true;
}

asio::awaitable<error_code> HttpConnection::write(Parts parts) {
    stream_.tcp().expires_after(context_->options.write_stall);
    const auto [error, size] = co_await asio::async_write(stream_, parts, kToken);
    co_return error;
}

// Ends the connection. Closing a socket with unread data resets it, and the peer may lose the answer: so this side
// stops sending first, and reads what the peer still sends.
asio::awaitable<void> HttpConnection::linger() {
    stream_.tcp().expires_after(kLinger);
    if (stream_.tls()) {
        co_await stream_.tls()->async_shutdown(kToken);
        co_return stream_.tcp().close();
    }
    co_await lingerOpenly();
}

asio::awaitable<void> HttpConnection::lingerOpenly() {
    stream_.tcp().expires_after(kLinger);
    error_code ignored;
    stream_.tcp().socket().shutdown(tcp::socket::shutdown_send, ignored);
    std::array<char, 4096> bin;
    for (size_t total = 0; total < (64u << 10);) {
        const auto [error, size] = co_await stream_.tcp().async_read_some(asio::buffer(bin), kToken);
        if (error) break;
        total += size;
    }
    stream_.tcp().close();
}

void serveHttp(std::shared_ptr<const Context> context, ByteStream stream, std::unique_ptr<ConnectionSlot> slot) {
    std::make_shared<HttpConnection>(std::move(context), std::move(stream), std::move(slot))->start();
}

} // namespace brume::net

#include "server/net/http.h"

#include <array>
#include <optional>

#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <fmt/format.h>

#include "protocol/message.h"
#include "server/net/access.h"
#include "server/net/coroutine.h"
#include "server/net/origin.h"
#include "server/net/picture_query.h"
#include "server/net/request_check.h"
#include "server/net/viewer_handle.h"
#include "server/net/viewers.h"
#include "server/net/websocket.h"

namespace brume::net {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;

constexpr char kBoundary[] = "brume-frame";
constexpr auto kLinger = std::chrono::seconds(1); // for the peer to read the last answer before the socket closes

// The status line and the headers, without Content-Length and the empty line at the end.
std::string headOf(const Reply& reply, std::string_view connection) {
    const beast::string_view reason = http::obsolete_reason(http::status(reply.status));
    std::string head = fmt::format("HTTP/1.1 {} {}\r\nServer: brume/{}\r\nConnection: {}\r\nContent-Type: {}\r\n"
                                   "X-Content-Type-Options: nosniff\r\n",
                                   reply.status, std::string_view(reason.data(), reason.size()), BRUME_VERSION,
                                   connection, reply.content_type);
    for (const auto& [name, value] : reply.headers) head += fmt::format("{}: {}\r\n", name, value);
    return head;
}

class HttpConnection final : public Connection, public std::enable_shared_from_this<HttpConnection> {
public:
    HttpConnection(std::shared_ptr<const Context> context, ByteStream stream, std::unique_ptr<ConnectionSlot> slot)
        : context_(std::move(context)), slot_(std::move(slot)), stream_(std::move(stream)),
          event_(std::make_shared<Event>(stream_.get_executor())) {
        context_->metrics.connected(1);
    }
    ~HttpConnection() override { context_->metrics.connected(-1); }

    void start() {
        slot_->assign(shared_from_this());
        asio::co_spawn(
            stream_.get_executor(), [self = shared_from_this()] { return self->run(); }, kLogFailure);
    }
    void stop() override {
        asio::post(stream_.get_executor(), [self = shared_from_this()] {
            self->event_->notify();
            if (self->idle_) self->stream_.tcp().close();
        });
    }
    void kill() override {
        asio::post(stream_.get_executor(), [self = shared_from_this()] {
            self->event_->notify();
            self->stream_.tcp().close();
        });
    }

private:
    using Parts = std::array<asio::const_buffer, 3>;

    asio::awaitable<void> run();
    asio::awaitable<bool> secure();
    asio::awaitable<bool> answer(const HttpRequest& request);
    asio::awaitable<bool> upgrade(const HttpRequest& request, Authorization authorization);
    asio::awaitable<bool> snapshot(const HttpRequest& request, std::string_view query);
    asio::awaitable<bool> stream(const HttpRequest& request, std::string_view query, Authorization authorization);
    asio::awaitable<bool> send(const HttpRequest& request, std::string_view route, Reply reply);
    asio::awaitable<error_code> write(Parts parts);
    asio::awaitable<FramePtr> nextFrame(ViewerHandle& handle);
    asio::awaitable<void> linger();
    Reply health(std::string_view path) const;

    std::shared_ptr<const Context> context_;
    std::unique_ptr<ConnectionSlot> slot_; // null once the connection is a WebSocket
    ByteStream stream_;
    beast::flat_buffer buffer_;
    std::shared_ptr<Event> event_; // notified when a frame is ready, and when the server stops
    bool idle_ = false;            // true: the connection waits for a request or a TLS handshake
};

asio::awaitable<void> HttpConnection::run() {
    const NetOptions& options = context_->options;
    const bool secured = co_await secure();
    if (!secured) co_return;
    for (bool first = true; !context_->stopping; first = false) {
        RequestParser parser;
        parser.header_limit(options.max_header_bytes);
        stream_.tcp().expires_after(first ? options.handshake : options.idle);
        idle_ = true;
        const auto [error, size] = co_await http::async_read_header(stream_, buffer_, parser, kToken);
        idle_ = false;
        if (auto refusal = unfit(error, parser, options)) {
            co_await send(parser.get(), "refused", *std::move(refusal));
            break;
        }
        if (error) co_return; // the connection was closed or reset, or no request came in time
        const bool again = co_await answer(parser.get());
        if (!again) break;
    }
    if (slot_) co_await linger();
}

// The TLS handshake, if the server has TLS. False if it failed: a peer without TLS cannot be told anything.
asio::awaitable<bool> HttpConnection::secure() {
    ByteStream::Tls* const tls = stream_.tls();
    if (!tls) co_return true;
    idle_ = true;
    stream_.tcp().expires_after(context_->options.handshake);
    const auto [error] = co_await tls->async_handshake(asio::ssl::stream_base::server, kToken);
    idle_ = false;
    if (error && !context_->stopping) {
        context_->metrics.refused("tls");
        spdlog::debug("{}: no TLS: {}", slot_->address(), error.message());
    }
    co_return !error;
}

// True when another request may follow.
asio::awaitable<bool> HttpConnection::answer(const HttpRequest& request) {
    const std::string_view target(request.target().data(), request.target().size());
    const size_t question = std::min(target.find('?'), target.size());
    const std::string_view path = target.substr(0, question),
                           query = target.substr(std::min(question + 1, target.size()));

    const bool operators = path == "/metrics" || path == "/viewers";
    const bool guarded = path == "/ws" || path == "/snapshot.jpg" || path == "/stream.mjpg" || operators;
    if (auto stranger = foreign(request, guarded, context_->options)) {
        context_->metrics.refused(stranger->reason);
        return send(request, "refused", std::move(stranger->reply));
    }
    if (guarded) {
        const auto bearer = request[http::field::authorization];
        auto checked = authorize({bearer.data(), bearer.size()}, query, operators ? Role::operator_ : Role::viewer,
                                 context_->options);
        if (auto* refusal = std::get_if<Reply>(&checked)) {
            context_->metrics.refused(refusal->status == 401 ? "token" : "forbidden");
            return send(request, "refused", std::move(*refusal));
        }
        auto& authorization = std::get<Authorization>(checked);
        if (path == "/ws") return upgrade(request, std::move(authorization));
        if (path == "/snapshot.jpg") return snapshot(request, query);
        if (path == "/stream.mjpg") return stream(request, query, std::move(authorization));
    }
    if (path == "/healthz" || path == "/readyz" || operators) return send(request, path.substr(1), health(path));
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
        reply.body = context_->metrics.text(context_->audience);
    } else if (path == "/viewers") {
        reply.content_type = "application/json";
        reply.body = viewersJson(context_->audience);
    } else if (context_->stopping)
        reply = lineReply(503, "not ready: the server stops");
    else if (context_->draining)
        reply = lineReply(503, "not ready: the server drains and will stop");
    else if (!context_->audience.ready)
        reply = lineReply(503, "not ready: no frame can be rendered yet");
    else
        reply = lineReply(200, "ready");
    reply.headers = {{"Cache-Control", "no-store"}};
    return reply;
}

// Makes the connection a WebSocket, or answers with one line that says why not.
asio::awaitable<bool> HttpConnection::upgrade(const HttpRequest& request, Authorization authorization) {
    const auto text = [](beast::string_view value) { return std::string_view(value.data(), value.size()); };
    const std::string_view origin = text(request[http::field::origin]);
    Reply refusal;
    if (!beast::websocket::is_upgrade(request)) {
        refusal = lineReply(426, "this is a WebSocket: connect with ws://, subprotocol brume.v1");
        refusal.headers = {{"Upgrade", "websocket"}};
    } else if (!http::token_list(request[http::field::sec_websocket_protocol]).exists(wire::kSubprotocol)) {
        refusal = lineReply(400, "the WebSocket subprotocol brume.v1 is needed");
    } else if (!originAllowed(origin, text(request[http::field::host]), context_->options.allowed_origins)) {
        refusal = lineReply(403, "pages of this origin may not connect: allow it with --allow-origin");
        context_->metrics.refused("origin");
    } else {
        serveWebSocket(context_, std::move(stream_), request, std::move(slot_), std::move(authorization));
        co_return false;
    }
    co_return co_await send(request, "ws", std::move(refusal));
}

// One frame of a camera that the query places.
asio::awaitable<bool> HttpConnection::snapshot(const HttpRequest& request, std::string_view query) {
    const auto send503 = [&](const char* line) {
        Reply reply = lineReply(503, line);
        reply.headers = {{"Retry-After", "5"}};
        return send(request, "snapshot", std::move(reply));
    };
    if (request.method() == http::verb::head)
        co_return co_await send(request, "snapshot", lineReply(405, "only GET is served here"));
    auto read = readPictureQuery(query, context_->options, context_->audience.facts());
    if (auto* wrong = std::get_if<std::string>(&read))
        co_return co_await send(request, "snapshot", lineReply(400, std::move(*wrong)));

    FramePtr frame;
    std::string refusal;
    {
        const Counted open(context_->snapshots);
        const bool room = open.number() <= context_->options.max_snapshots;
        const auto handle =
            room ? ViewerHandle::join(context_->audience, context_->metrics, event_->notifier(), 1) : nullptr;
        if (!handle) {
            context_->metrics.refused("snapshots");
            co_return co_await send503("too many snapshots or viewers: try again later");
        }
        PoseRequest pose = std::get<PictureQuery>(read).request;
        pose.received = Clock::now();
        handle->viewer().setPose(pose);
        frame = co_await nextFrame(*handle);
        refusal = handle->viewer().refusal();
    }
    if (!refusal.empty()) co_return co_await send(request, "snapshot", lineReply(400, std::move(refusal)));
    if (!frame) co_return co_await send503("no frame came in time: see /readyz");
    context_->metrics.sent(frame->jpeg[0]->size(), 0);
    Reply reply;
    reply.content_type = "image/jpeg";
    reply.body.assign(frame->jpeg[0]->begin(), frame->jpeg[0]->end());
    reply.headers = {{"Cache-Control", "no-store"}};
    co_return co_await send(request, "snapshot", std::move(reply));
}

// Motion JPEG: every part is followed by its boundary at once, so that a reader shows it without waiting for the next.
asio::awaitable<bool> HttpConnection::stream(const HttpRequest& request, std::string_view query,
                                             Authorization authorization) {
    const auto send503 = [&](const char* line) {
        Reply reply = lineReply(503, line);
        reply.headers = {{"Retry-After", "5"}};
        return send(request, "stream", std::move(reply));
    };
    if (request.method() == http::verb::head)
        co_return co_await send(request, "stream", lineReply(405, "only GET is served here"));
    auto read = readPictureQuery(query, context_->options, context_->audience.facts());
    if (auto* wrong = std::get_if<std::string>(&read))
        co_return co_await send(request, "stream", lineReply(400, std::move(*wrong)));
    PictureQuery picture = std::get<PictureQuery>(read);

    const Counted open(context_->streams);
    const bool room = open.number() <= context_->options.max_streams;
    const auto handle =
        room ? ViewerHandle::join(context_->audience, context_->metrics, event_->notifier(), 1) : nullptr;
    if (!handle) {
        context_->metrics.refused("streams");
        co_return co_await send503("too many streams or viewers: try again later");
    }
    picture.request.received = Clock::now();
    handle->viewer().drawAlways();
    handle->viewer().setPose(picture.request);
    FramePtr frame = co_await nextFrame(*handle);
    if (std::string refusal = handle->viewer().refusal(); !refusal.empty())
        co_return co_await send(request, "stream", lineReply(400, std::move(refusal)));
    if (!frame) co_return co_await send503("no frame came in time: see /readyz");

    context_->metrics.requested("stream", 200);
    spdlog::info("viewer {}: stream to {}, {}x{}", handle->viewer().id(), slot_->address(), picture.request.width,
                 picture.request.height);
    Reply opening;
    opening.content_type = fmt::format("multipart/x-mixed-replace; boundary={}", kBoundary);
    opening.headers = {{"Cache-Control", "no-store"}};
    std::string head = headOf(opening, "close") + fmt::format("\r\n--{}\r\n", kBoundary);
    const std::string tail = fmt::format("\r\n--{}\r\n", kBoundary);
    const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<float>(1 / picture.fps));
    auto due = Clock::now();
    while (frame && !context_->stopping && Clock::now() < authorization.until.value_or(Clock::time_point::max())) {
        const std::vector<uint8_t>& jpeg = *frame->jpeg[0];
        head += fmt::format("Content-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", jpeg.size());
        context_->metrics.sent(jpeg.size(), 0);
        const Parts part{asio::buffer(head), asio::buffer(jpeg), asio::buffer(tail)};
        const error_code error = co_await write(part);
        if (error) break;
        head.clear();
        // The next frame is asked for one period after this one, not at once.
        due = std::max(due + period, Clock::now());
        while (Clock::now() < due && !context_->stopping) co_await event_->wait(due);
        handle->viewer().acknowledge(frame->id);
        frame = co_await nextFrame(*handle);
    }
    spdlog::info("viewer {}: stream ended after {} frames", handle->viewer().id(), handle->viewer().counts().sent);
    co_return false;
}

// Waits for the viewer's next frame. Null if no frame comes in time, the server refuses the viewer, or it stops.
asio::awaitable<FramePtr> HttpConnection::nextFrame(ViewerHandle& handle) {
    const auto deadline = Clock::now() + context_->options.frame_wait;
    for (;;) {
        FramePtr frame = handle.takeFrame();
        const bool over = context_->stopping || Clock::now() >= deadline || !handle.viewer().refusal().empty();
        if (frame || over) co_return frame;
        co_await event_->wait(deadline);
    }
}

// Header and body are two buffers, written together.
asio::awaitable<bool> HttpConnection::send(const HttpRequest& request, std::string_view route, Reply reply) {
    context_->metrics.requested(route, reply.status);
    const bool again = request.keep_alive() && !reply.close && !context_->stopping;
    std::string head = headOf(reply, again ? "keep-alive" : "close");
    if (reply.status != 304) head += fmt::format("Content-Length: {}\r\n", reply.body.size());
    head += "\r\n";
    if (request.method() == http::verb::head) reply.body.clear();
    const Parts parts{asio::buffer(head), asio::buffer(reply.body)};
    const error_code error = co_await write(parts);
    co_return !error && again;
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
    error_code ignored;
    stream_.tcp().socket().shutdown(tcp::socket::shutdown_send, ignored);
    std::array<char, 4096> bin;
    for (size_t total = 0; total < (64u << 10);) {
        const auto [error, size] = co_await stream_.async_read_some(asio::buffer(bin), kToken);
        if (error) break;
        total += size;
    }
    stream_.tcp().close();
}

} // namespace

void serveHttp(std::shared_ptr<const Context> context, ByteStream stream, std::unique_ptr<ConnectionSlot> slot) {
    std::make_shared<HttpConnection>(context, std::move(stream), std::move(slot))->start();
}

} // namespace brume::net

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
#include "server/net/picture_reply.h"
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

constexpr auto kRepeatAfter = std::chrono::seconds(1); // of a stream: players take a longer pause for its end
constexpr uint8_t kSnapshotQuality = 90;               // JPEG, as of every picture at rest
constexpr char kNoFrame[] = "no picture came in time: shaders may be compiling, which is done once; see /readyz";

// True if the client takes PNG and does not take JPEG.
bool prefersPng(const HttpRequest& request) {
    const auto accept = request[http::field::accept];
    const std::string_view types(accept.data(), accept.size());
    return types.find("image/png") != types.npos && types.find("image/jpeg") == types.npos &&
           types.find("image/*") == types.npos && types.find("*/*") == types.npos;
}

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
    asio::awaitable<bool> snapshot(const HttpRequest& request, bool png, std::string_view query);
    asio::awaitable<bool> stream(const HttpRequest& request, std::string_view query, Authorization authorization);
    asio::awaitable<bool> send(const HttpRequest& request, std::string_view route, Reply reply);
    asio::awaitable<bool> sendLater(const HttpRequest& request, std::string_view route, std::string line);
    asio::awaitable<error_code> write(Parts parts);
    asio::awaitable<FramePtr> nextFrame(ViewerHandle& handle, Clock::duration patience);
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
    const bool guarded =
        path == "/ws" || path == "/snapshot.jpg" || path == "/snapshot.png" || path == "/stream.mjpg" || operators;
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
        if (path == "/snapshot.jpg" || path == "/snapshot.png") return snapshot(request, path.ends_with("png"), query);
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

// A picture cannot be had now: says why, to the client and in the log, and when to try again.
asio::awaitable<bool> HttpConnection::sendLater(const HttpRequest& request, std::string_view route, std::string line) {
    spdlog::info("{} for {} refused: {}", route, slot_->address(), line);
    Reply reply = lineReply(503, std::move(line));
    reply.headers = {{"Retry-After", "5"}};
    return send(request, route, std::move(reply));
}

// One still picture of a camera that the query places, within the scene's error whatever the load.
asio::awaitable<bool> HttpConnection::snapshot(const HttpRequest& request, bool png, std::string_view query) {
    if (request.method() == http::verb::head)
        co_return co_await send(request, "snapshot", lineReply(405, "only GET is served here"));
    auto read = readPictureQuery(query, context_->options, context_->audience.facts());
    if (auto* wrong = std::get_if<std::string>(&read))
        co_return co_await send(request, "snapshot", lineReply(400, std::move(*wrong)));
    const PictureQuery& picture = std::get<PictureQuery>(read);

    FramePtr frame;
    std::string refusal;
    {
        const Counted open(context_->snapshots);
        const uint32_t most = context_->options.max_snapshots;
        if (open.number() > most) {
            context_->metrics.refused("snapshots");
            co_return co_await sendLater(request, "snapshot",
                                         fmt::format("{} snapshots are being drawn, the most at a time", most));
        }
        const auto handle = ViewerHandle::join(context_->audience, context_->metrics, event_->notifier(), 1);
        if (!handle) {
            context_->metrics.refused("snapshots");
            co_return co_await sendLater(request, "snapshot", context_->audience.whyFull());
        }
        PoseRequest pose = picture.request;
        pose.one_shot = true;
        pose.lossless = pose.lossless || png || prefersPng(request);
        if (!picture.has_quality) pose.quality = std::max(pose.quality, kSnapshotQuality);
        pose.received = Clock::now();
        handle->viewer().setPose(pose);
        frame = co_await nextFrame(*handle, context_->options.frame_wait);
        refusal = handle->viewer().refusal();
    }
    if (!refusal.empty()) co_return co_await send(request, "snapshot", lineReply(400, std::move(refusal)));
    if (!frame) co_return co_await sendLater(request, "snapshot", kNoFrame);
    context_->metrics.sent(frame->jpeg[0]->size(), 0);
    Reply reply;
    reply.content_type = contentTypeOf(*frame);
    reply.body.assign(frame->jpeg[0]->begin(), frame->jpeg[0]->end());
    reply.headers = headersOf(*frame, picture);
    reply.headers.emplace_back("Cache-Control", "no-store");
    co_return co_await send(request, "snapshot", std::move(reply));
}

// Motion JPEG. A part that has not changed is sent again each second. Every part is followed by its boundary at once,
// so that a reader shows it without waiting for the next.
asio::awaitable<bool> HttpConnection::stream(const HttpRequest& request, std::string_view query,
                                             Authorization authorization) {
    if (request.method() == http::verb::head)
        co_return co_await send(request, "stream", lineReply(405, "only GET is served here"));
    auto read = readPictureQuery(query, context_->options, context_->audience.facts());
    if (auto* wrong = std::get_if<std::string>(&read))
        co_return co_await send(request, "stream", lineReply(400, std::move(*wrong)));
    PictureQuery picture = std::get<PictureQuery>(read);

    if (picture.request.lossless)
        co_return co_await send(request, "stream", lineReply(400, "a stream is JPEG; /snapshot.png is a PNG"));
    const Counted open(context_->streams);
    const uint32_t most = context_->options.max_streams;
    if (open.number() > most) {
        context_->metrics.refused("streams");
        co_return co_await sendLater(request, "stream", fmt::format("{} streams are open, the most at a time", most));
    }
    const auto handle = ViewerHandle::join(context_->audience, context_->metrics, event_->notifier(), 1);
    if (!handle) {
        context_->metrics.refused("streams");
        co_return co_await sendLater(request, "stream", context_->audience.whyFull());
    }
    picture.request.received = Clock::now();
    handle->viewer().setPose(picture.request);
    FramePtr frame = co_await nextFrame(*handle, context_->options.frame_wait);
    if (std::string refusal = handle->viewer().refusal(); !refusal.empty())
        co_return co_await send(request, "stream", lineReply(400, std::move(refusal)));
    if (!frame) co_return co_await sendLater(request, "stream", kNoFrame);

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
        head += fmt::format("Content-Type: image/jpeg\r\nContent-Length: {}\r\n", jpeg.size());
        for (const auto& [name, value] : headersOf(*frame, picture)) head += fmt::format("{}: {}\r\n", name, value);
        head += "\r\n";
        context_->metrics.sent(jpeg.size(), 0);
        const Parts part{asio::buffer(head), asio::buffer(jpeg), asio::buffer(tail)};
        const error_code error = co_await write(part);
        if (error) break;
        head.clear();
        // The next frame is asked for one period after this one, not at once.
        due = std::max(due + period, Clock::now());
        while (Clock::now() < due && !context_->stopping) co_await event_->wait(due);
        handle->viewer().acknowledge(frame->id);
        if (FramePtr next = co_await nextFrame(*handle, kRepeatAfter)) frame = std::move(next);
        if (!handle->viewer().refusal().empty()) break;
    }
    spdlog::info("viewer {}: stream ended after {} frames", handle->viewer().id(), handle->viewer().counts().sent);
    co_return false;
}

// Waits for the viewer's next frame. Null if no frame comes in time, the server refuses the viewer, or it stops.
asio::awaitable<FramePtr> HttpConnection::nextFrame(ViewerHandle& handle, Clock::duration patience) {
    const auto deadline = Clock::now() + patience;
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

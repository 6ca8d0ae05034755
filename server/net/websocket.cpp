#include "server/net/websocket.h"

#include <algorithm>
#include <span>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "server/net/origin.h"
#include "server/net/outgoing.h"
#include "server/net/tcp_state.h"
#include "server/net/websocket_session.h"

namespace brume::net {
namespace {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

constexpr auto kHeartbeat = std::chrono::milliseconds(100); // how often deadlines and news of the scene are checked
constexpr size_t kMaxControl = 64; // control messages that wait for the socket; with so many, run() reads no more
constexpr auto kCloseHandshake = std::chrono::seconds(1);

float millisecondsSince(Clock::time_point start) {
    return std::chrono::duration<float, std::milli>(Clock::now() - start).count();
}

} // namespace

asio::awaitable<void> WebSocketSession::run(HttpRequest request) {
    websocket::stream_base::timeout timeout{context_->options.handshake, context_->options.idle, true};
    ws_.set_option(timeout);
    ws_.set_option(websocket::stream_base::decorator(
        [policy = resourcePolicy(context_->options)](websocket::response_type& response) {
            response.set(beast::http::field::sec_websocket_protocol, wire::kSubprotocol);
            response.set(beast::http::field::server, "brume/" BRUME_VERSION);
            response.set("Cross-Origin-Resource-Policy", policy);
        }));
    ws_.read_message_max(context_->options.max_message_bytes);
    ws_.auto_fragment(false);
    ws_.binary(true);
    ws_.next_layer().tcp().expires_never(); // the timeouts above apply instead
    ws_.control_callback([this](websocket::frame_type, beast::string_view text) { mere_.control(text.size()); });
    const auto [refused] = co_await ws_.async_accept(request, kToken);
    if (refused) {
        context_->metrics.requested("ws", 400);
        co_return finish(refused.message());
    }
    context_->metrics.requested("ws", 101);
    asio::co_spawn(
        ws_.get_executor(), [self = shared_from_this()] { return self->write(); }, kLogFailure);
    asio::co_spawn(
        ws_.get_executor(), [self = shared_from_this()] { return self->beat(); }, kLogFailure);

    beast::flat_buffer buffer; // holds one whole message at a time, so that its bytes are aligned
    asio::steady_timer pause(ws_.get_executor());
    Actions actions;
    while (!ended_) {
        const auto [error, size] = co_await ws_.async_read(buffer, kToken);
        if (error) {
            if (error == websocket::error::message_too_big)
                context_->metrics.refused("oversized"); // Beast closed with 1009
            // While closing, write() completes the closing handshake.
            if (!closing_) {
                if (error != websocket::error::closed && handle_) handle_->markLost();
                finish(error == websocket::error::closed ? "the viewer closed" : error.message());
            }
            co_return;
        }
        const auto now = Clock::now();
        const auto data = buffer.cdata();
        actions.clear();
        mere_.message(size);
        rules_.onMereFrames(mere_.take(ws_.next_layer().received()), now, actions);
        if (ws_.got_text())
            rules_.onText(now, actions);
        else
            rules_.onMessage({static_cast<const uint8_t*>(data.data()), data.size()}, now, actions);
        carryOut(actions);
        buffer.consume(buffer.size());
        if (const auto wait = rules_.pause(now); wait > Clock::duration::zero()) {
            pause.expires_after(wait);
            co_await pause.async_wait(kToken);
        }
        while (!ended_ && control_.size() >= kMaxControl) co_await taken_->wait();
    }
}

// Writes control messages first, then news of the scene, then the newest frame; the closing handshake last.
asio::awaitable<void> WebSocketSession::write() {
    while (!ended_) {
        error_code error;
        tellRefusedInputs();
        if (!control_.empty() || ping_due_ || newsAreDue()) {
            wire::Packed message;
            if (ping_due_) {
                message = newPing();
            } else if (control_.empty()) {
                message = takeNews();
            } else {
                message = std::move(control_.front());
                control_.pop_front();
                taken_->notify();
            }
            const Parts parts{asio::buffer(message.data(), message.size())};
            error = co_await send(parts);
        } else if (closing_) {
            ws_.set_option(websocket::stream_base::timeout{kCloseHandshake, kCloseHandshake, false});
            co_await ws_.async_close(*closing_, kToken);
            co_return finish();
        } else if (FramePtr frame = handle_ ? handle_->takeFrame() : nullptr) {
            error = co_await sendFrame(std::move(frame));
        } else {
            co_await event_->wait();
        }
        if (error) {
            if (handle_) handle_->markLost();
            co_return finish(error.message());
        }
    }
}

// The header is packed here; the JPEG bytes are sent from where the encoder wrote them.
asio::awaitable<error_code> WebSocketSession::sendFrame(FramePtr frame) {
    const float queue_ms = millisecondsSince(frame->encoded);
    const wire::Packed header = frame->lit ? packLitHeader(*frame, queue_ms) : packFrameHeader(*frame, queue_ms);
    Parts parts{asio::buffer(header.data(), header.size())};
    size_t next = 1;
    frame->eachPart([&](std::span<const uint8_t> bytes) { parts[next++] = asio::buffer(bytes.data(), bytes.size()); });
    room_->metrics.sent(asio::buffer_size(parts), queue_ms);
    const error_code error = co_await send(parts);
    backlog_ = backlog_ || tcpState(ws_.next_layer().tcp().socket().native_handle()).backlog;
    co_return error;
}

asio::awaitable<error_code> WebSocketSession::send(Parts parts) {
    write_began_ = Clock::now();
    const auto [error, size] = co_await ws_.async_write(parts, kToken);
    write_began_.reset();
    co_return error;
}

asio::awaitable<void> WebSocketSession::beat() {
    Actions actions;
    while (!ended_) {
        heartbeat_.expires_after(kHeartbeat);
        co_await heartbeat_.async_wait(kToken);
        const auto now = Clock::now();
        if (write_began_ && now - *write_began_ > context_->options.write_stall) {
            if (handle_) handle_->markLost();
            co_return finish("it takes no data");
        }
        actions.clear();
        rules_.onMereFrames(mere_.take(ws_.next_layer().received()), now, actions);
        rules_.onTick(now, actions);
        carryOut(actions);
        if (handle_ && !closing_) {
            ping_due_ = pings_.due(now);
            if (handle_->viewer().observe(now, std::exchange(backlog_, false)) > context_->options.silence) {
                handle_->markLost();
                close(kCloseTryLater, "no frame was acknowledged for too long", kRetryRestart);
            } else if (const std::string why = handle_->viewer().refusal(); !why.empty()) {
                context_->metrics.refused("undrawable");
                enqueue(packError(wire::ErrorCode::out_of_range, why, 0));
                close(kClosePolicy, why);
            }
        }
        event_->notify();
    }
}

// A ping is packed when the socket takes it, so that the round trip does not include waiting in this program.
wire::Packed WebSocketSession::newPing() {
    ping_due_ = false;
    const auto now = Clock::now();
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch()).count();
    return packPing(pings_.send(now), uint64_t(us));
}

void WebSocketSession::ponged(uint32_t nonce) {
    const auto now = Clock::now();
    const std::optional<Clock::duration> round_trip = pings_.answer(nonce, now);
    if (!round_trip || !handle_) return;
    const TcpState tcp = tcpState(ws_.next_layer().tcp().socket().native_handle());
    backlog_ = backlog_ || tcp.backlog;
    handle_->viewer().ponged(*round_trip, now, backlog_ ? Pacing::Millis::max() : tcp.queue);
}

// The queue is bounded: run() reads nothing while kMaxControl messages wait, and each message read adds only a few.
void WebSocketSession::enqueue(wire::Packed message) {
    if (ended_ || closing_) return;
    control_.push_back(std::move(message));
    event_->notify();
}

bool WebSocketSession::newsAreDue() const {
    return handle_ && !closing_ && (news_.due(Clock::now()) || people_news_.due(Clock::now()));
}

wire::Packed WebSocketSession::welcome() {
    const SceneFacts& shown = news_.takeScene();
    rules_.shows({shown.scene.medium.layout, shown.scene.medium.count});
    return packWelcome(handle_->viewer(), granted_, room_->audience, shown, authorization_.role);
}

// Another scene is told of first, and what changed in it by the next call.
wire::Packed WebSocketSession::takeNews() {
    if (news_.anotherScene()) return welcome();
    const auto now = Clock::now();
    return news_.due(now) ? news_.takeState(now) : people_news_.take(now);
}

// Ends the session once. Every coroutine then finds ended_ set or its operation aborted.
void WebSocketSession::finish(std::string_view why) {
    if (ended_) return;
    ended_ = true;
    leave(why);
    ws_.next_layer().tcp().close();
    heartbeat_.cancel();
    event_->notify();
    taken_->notify();
}

void serveWebSocket(std::shared_ptr<const Context> context, RoomPtr room, ByteStream stream, const HttpRequest& request,
                    std::unique_ptr<ConnectionSlot> slot, Authorization authorization) {
    std::make_shared<WebSocketSession>(std::move(context), std::move(room), std::move(stream), std::move(slot),
                                       std::move(authorization))
        ->start(request);
}

} // namespace brume::net

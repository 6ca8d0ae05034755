// One viewer's WebSocket. What its messages ask for is in websocket_actions.cpp, how bytes pass in websocket.cpp.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include <boost/beast/websocket/stream.hpp>

#include "protocol/net/byte_stream.h"
#include "server/net/access.h"
#include "server/net/context.h"
#include "server/net/coroutine.h"
#include "server/net/mere_frames.h"
#include "server/net/people_news.h"
#include "server/net/pings.h"
#include "server/net/request_check.h"
#include "server/net/scene_news.h"
#include "server/net/session_rules.h"
#include "server/net/viewer_handle.h"

namespace brume::net {

inline constexpr float kRetryRestart = 2; // s: Goodbye::retry_after_s of a stopping server

// Three coroutines on the connection's strand: run() reads, write() writes, beat() keeps the time. Each holds the
// session alive.
class WebSocketSession final : public Connection, public std::enable_shared_from_this<WebSocketSession> {
public:
    WebSocketSession(std::shared_ptr<const Context> context, RoomPtr room, ByteStream stream,
                     std::unique_ptr<ConnectionSlot> slot, Authorization authorization)
        : context_(std::move(context)), room_(std::move(room)), slot_(std::move(slot)), ws_(std::move(stream)),
          authorization_(std::move(authorization)),
          mere_(context_->options.max_message_bytes, ws_.next_layer().received()),
          rules_(context_->options, room_->audience.facts(), Clock::now(), authorization_),
          event_(std::make_shared<Event>(ws_.get_executor())), taken_(std::make_shared<Event>(ws_.get_executor())),
          heartbeat_(ws_.get_executor()), news_(room_->audience), people_news_(room_->audience.people()) {}

    void start(const HttpRequest& request) {
        slot_->assign(shared_from_this());
        asio::co_spawn(
            ws_.get_executor(), [self = shared_from_this(), request] { return self->run(request); }, kLogFailure);
    }

    void stop() override {
        asio::post(ws_.get_executor(),
                   [self = shared_from_this()] { self->close(kCloseGoingAway, "the server stops", kRetryRestart); });
    }
    void kill() override {
        asio::post(ws_.get_executor(), [self = shared_from_this()] { self->finish("cut by the server's stop"); });
    }

private:
    // One message: header, pictures, their layers' pictures.
    using Parts = std::array<asio::const_buffer, 1 + wire::kMaxViews*(1 + wire::kLayerPictures)>;

    asio::awaitable<void> run(HttpRequest request);
    asio::awaitable<void> write();
    asio::awaitable<void> beat();
    asio::awaitable<error_code> sendFrame(FramePtr frame);
    asio::awaitable<error_code> send(Parts parts);

    void carryOut(Actions& actions);
    void admit(const Admit& hello);
    void acknowledge(uint32_t frame);
    void command(const EnqueueCommand& given);
    void lead(uint32_t person);
    People& people() const { return room_->audience.people(); }
    wire::Packed newPing();
    void ponged(uint32_t nonce);
    void close(uint16_t code, std::string_view reason, float retry_after_s = 0, const std::string& go_to = {});
    void leave(std::string_view why);
    void log(const std::string& line) const { context_->log.write(spdlog::level::info, slot_->network(), line); }

    void enqueue(wire::Packed message);
    void tellRefusedInputs();
    bool newsAreDue() const;
    wire::Packed welcome();
    wire::Packed takeNews();
    void finish(std::string_view why = {});

    std::shared_ptr<const Context> context_;
    const RoomPtr room_;
    std::unique_ptr<ConnectionSlot> slot_;
    boost::beast::websocket::stream<ByteStream, false> ws_; // no compression: JPEG does not shrink
    const Authorization authorization_;
    MereFrames mere_;
    SessionRules rules_;
    std::shared_ptr<Event> event_; // notified when there may be something to write
    std::shared_ptr<Event> taken_; // notified when write() takes a control message
    asio::steady_timer heartbeat_;
    std::unique_ptr<ViewerHandle> handle_; // null before Hello
    std::string name_;                     // for the log
    std::deque<wire::Packed> control_;
    Pings pings_;
    bool ping_due_ = false;
    std::optional<Clock::time_point> write_began_;
    bool backlog_ = false; // true: bytes waited for the link since the last heartbeat
    std::optional<boost::beast::websocket::close_reason> closing_; // set: write() closes once control_ is empty
    SceneNews news_;
    PeopleNews people_news_;
    PoseRequest granted_; // by the hello
    bool ended_ = false;
};

} // namespace brume::net

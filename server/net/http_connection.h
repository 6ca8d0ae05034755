// One connection that speaks HTTP, until it ends or becomes a WebSocket. Pictures are in http_pictures.cpp, scenes in
// http_scenes.cpp, replays in http_replay.cpp, rooms in http_rooms.cpp, all else in http.cpp.
#pragma once

#include <array>
#include <optional>

#include <boost/beast/core/flat_buffer.hpp>

#include "protocol/net/byte_stream.h"
#include "server/net/access.h"
#include "server/net/context.h"
#include "server/net/coroutine.h"
#include "server/net/request_check.h"
#include "server/net/viewer_handle.h"

namespace brume::net {

// The status line and the headers, without Content-Length and the empty line at the end.
std::string headOf(const Reply& reply, std::string_view connection, const NetOptions& options);

class HttpConnection final : public Connection, public std::enable_shared_from_this<HttpConnection> {
public:
    HttpConnection(std::shared_ptr<const Context> context, ByteStream stream, std::unique_ptr<ConnectionSlot> slot)
        : context_(std::move(context)), room_(context_->rooms.home()), slot_(std::move(slot)),
          stream_(std::move(stream)), event_(std::make_shared<Event>(stream_.get_executor())),
          proxy_(Address::read(slot_->address()).value_or(Address())) {
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
    asio::awaitable<bool> another();
    Clock::duration headerTime() const;
    asio::awaitable<bool> answer(RequestParser& parser);
    std::optional<Reply> receive(const HttpRequest& request); // http_forwarded.cpp
    asio::awaitable<bool> upgrade(const HttpRequest& request, Authorization authorization);
    asio::awaitable<bool> snapshot(const HttpRequest& request, std::string_view kind, std::string_view query,
                                   Authorization authorization);
    Newcomer newcomer(const Authorization& authorization) const;
    asio::awaitable<bool> stream(const HttpRequest& request, std::string_view query, Authorization authorization);
    asio::awaitable<bool> send(const HttpRequest& request, std::string_view route, Reply reply);
    // http_rooms.cpp
    asio::awaitable<bool> changeRooms(const HttpRequest& request, std::string_view path, std::string_view query);
    std::string metricsText() const;
    asio::awaitable<bool> pause(const HttpRequest& request, bool on);
    asio::awaitable<bool> seek(const HttpRequest& request, std::string_view query); // http_replay.cpp
    // http_scenes.cpp
    asio::awaitable<bool> showScene(const HttpRequest& request, std::string_view query);
    asio::awaitable<bool> showCloud(RequestParser& parser, std::string_view query, Authorization authorization);
    asio::awaitable<bool> change(const HttpRequest& request, std::string_view route, SceneWish scene);
    asio::awaitable<bool> particles(const HttpRequest& request);
    Reply sceneFile(std::string_view query) const;
    asio::awaitable<bool> sendLater(const HttpRequest& request, std::string_view route, std::string line);
    void share(const HttpRequest& request, Reply& reply) const;
    asio::awaitable<bool> drop(uint64_t bytes);
    asio::awaitable<error_code> write(Parts parts);
    asio::awaitable<FramePtr> nextFrame(ViewerHandle& handle, Clock::duration patience);
    // Looks for the end of the connection for as long as it lives.
    class PeerWatch {
    public:
        explicit PeerWatch(HttpConnection& connection);
        ~PeerWatch();
        PeerWatch(const PeerWatch&) = delete;
        PeerWatch& operator=(const PeerWatch&) = delete;

    private:
        HttpConnection& connection_;
        const std::shared_ptr<bool> over_ = std::make_shared<bool>(false);
    };
    asio::awaitable<void> watchPeer(std::shared_ptr<const bool> over);
    asio::awaitable<void> linger();
    asio::awaitable<void> lingerOpenly(); // without TLS
    Reply health(std::string_view path) const;

    std::shared_ptr<const Context> context_;
    RoomPtr room_;                         // that the request is for; never null while it is answered
    std::unique_ptr<ConnectionSlot> slot_; // null once the connection is a WebSocket
    ByteStream stream_;
    boost::beast::flat_buffer buffer_;
    std::shared_ptr<Event> event_; // notified when a frame is ready, the peer has gone, and when the server stops
    const Address proxy_;          // that the connection comes from, where its slot is for others
    bool idle_ = false;            // true: the connection waits for a request or a TLS handshake
    bool gone_ = false;            // true: the peer has closed the connection while it waited for pictures
    bool unread_ = false;          // true: a body follows that nobody has read, so that no other request can
};

} // namespace brume::net

// Of the client, this file and http_get.cpp alone see Beast, which is slow to compile.
#include "client/native/connection.h"

#include <deque>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "client/native/tls.h"
#include "common/text.h"
#include "protocol/message.h"
#include "protocol/net/byte_stream.h"

namespace brume::client {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

// Silence for this long, the server's answers to keep-alive pings included, means that it is gone.
constexpr std::chrono::seconds kIdleTimeout{20};

std::string reasonOf(error_code error) {
    if (error == beast::error::timeout) return "no answer in time";
    return error.message();
}

} // namespace

struct Loop::Io {
    asio::io_context context{1};
    TlsContexts tls; // after the context that streams live in
};

Loop::Loop() : io_(std::make_shared<Io>()) {}

void Loop::wait(std::chrono::microseconds timeout) {
    if (io_->context.run_one_until(std::chrono::steady_clock::now() + timeout) > 0) io_->context.poll();
}

// What waits for the socket holds it (`self`), since a loop that is shared goes on when the connection is gone.
struct Connection::Socket : std::enable_shared_from_this<Socket> {
    Endpoint endpoint;
    std::chrono::milliseconds timeout;
    asio::io_context& io;
    tcp::resolver resolver{io};
    websocket::stream<ByteStream, false> stream; // no compression: no server of ours has it
    websocket::response_type response;
    beast::flat_buffer incoming;
    std::deque<Bytes> inbox, outbox;
    State state = State::connecting;
    bool parted = false;        // the closing handshake is over
    bool refused = false;       // Connection::refused()
    std::string closed_because; // one line

    Socket(Endpoint where, std::chrono::milliseconds time, Loop::Io& loop)
        : endpoint(std::move(where)), timeout(time), io(loop.context), stream(open(endpoint, loop)) {}

    static ByteStream open(const Endpoint& endpoint, Loop::Io& loop) {
        ByteStream::Tcp tcp(loop.context);
        return endpoint.tls ? ByteStream(std::move(tcp), loop.tls.of(endpoint.ca)) : ByteStream(std::move(tcp));
    }

    void closedNow(std::string why) {
        if (state == State::closed) return;
        state = State::closed;
        closed_because = oneLine(std::move(why));
        resolver.cancel();
        stream.next_layer().tcp().close();
    }

    void cannotConnect(const std::string& why, const std::string& question) {
        closedNow("cannot connect to " + endpoint.url() + ": " + why + " (" + question + ")");
    }

    // Resolve, connect, shake hands, then read for ever: each step starts the next.
    void resolve() {
        resolver.async_resolve(
            endpoint.host, std::to_string(endpoint.port),
            [this, self = shared_from_this()](error_code error, const tcp::resolver::results_type& addresses) {
                if (state == State::closed) return;
                if (error) return cannotConnect(error.message(), "is the host's name right?");
                connect(addresses);
            });
    }

    void connect(const tcp::resolver::results_type& addresses) {
        auto& tcp_stream = stream.next_layer().tcp();
        tcp_stream.expires_after(timeout);
        tcp_stream.async_connect(
            addresses, [this, self = shared_from_this(), &tcp_stream](error_code error, const tcp::endpoint&) {
                if (state == State::closed) return;
                if (error) return cannotConnect(reasonOf(error), "is the server running there?");
                error_code ignored; // a socket that cannot do it still works, only later
                tcp_stream.socket().set_option(tcp::no_delay(true), ignored);
                endpoint.tls ? secure() : shakeHands();
            });
    }

    void secure() {
        auto& tls = *stream.next_layer().tls();
        if (const std::string why = expectHost(tls, endpoint.host); !why.empty())
            return cannotConnect(why, "is its name right?");
        tls.async_handshake(asio::ssl::stream_base::client, [this, self = shared_from_this()](error_code error) {
            if (state == State::closed) return;
            refused = error && SSL_get_verify_result(stream.next_layer().tls()->native_handle()) != X509_V_OK;
            if (error)
                return cannotConnect(tlsFault(*stream.next_layer().tls(), error, reasonOf(error)),
                                     "is it TLS there? --ca");
            shakeHands();
        });
    }

    void shakeHands() {
        stream.next_layer().tcp().expires_never(); // the WebSocket has deadlines of its own
        stream.set_option(websocket::stream_base::timeout{timeout, kIdleTimeout, true});
        stream.set_option(websocket::stream_base::decorator([token = endpoint.token](websocket::request_type& request) {
            if (!token.empty()) request.set(beast::http::field::authorization, "Bearer " + token);
            request.set(beast::http::field::sec_websocket_protocol, wire::kSubprotocol);
            request.set(beast::http::field::user_agent, "brume-client/" BRUME_VERSION);
        }));
        stream.read_message_max(kMaxMessageBytes);
        stream.binary(true);
        const std::string host = endpoint.authority();
        stream.async_handshake(response, host, endpoint.path, [this, self = shared_from_this()](error_code error) {
            if (state == State::closed) return;
            if (error == websocket::error::upgrade_declined) return declined();
            if (error) return cannotConnect(reasonOf(error), "is it a brume server?");
            refused = response[beast::http::field::sec_websocket_protocol] != wire::kSubprotocol;
            if (refused)
                return cannotConnect("it does not speak " + std::string(wire::kSubprotocol),
                                     "are client and server of one version?");
            state = State::open;
            read();
        });
    }

    // A server of brume says in one line why it declines.
    void declined() {
        const unsigned status = response.result_int();
        std::string why = "it answers HTTP " + std::to_string(status) + " " + std::string(response.reason());
        refused = status / 100 == 4 && status != 408 && status != 429; // those two and 5xx pass
        const std::string& body = response.body();
        const std::string line = body.substr(0, std::min<size_t>(body.find_first_of("\r\n"), 200));
        const bool plain = response[beast::http::field::content_type].starts_with("text/plain");
        if (plain && !line.empty()) why += ": " + line;
        const bool trust_matters = status == 401 || status == 403;
        cannotConnect(why, trust_matters ? "--token-file" : "is it a brume server, and not full?");
    }

    void read() {
        stream.async_read(incoming, [this, self = shared_from_this()](error_code error, size_t) {
            if (state == State::closed) return;
            if (error == websocket::error::closed) {
                const auto& reason = stream.reason().reason;
                return closedNow("the server closed the connection" +
                                 (reason.empty() ? "" : ": " + std::string(reason.c_str())));
            }
            if (error) return closedNow("the connection to " + endpoint.url() + " was lost: " + reasonOf(error));
            const auto bytes = incoming.cdata();
            const auto* const begin = static_cast<const uint8_t*>(bytes.data());
            inbox.emplace_back(begin, begin + bytes.size());
            incoming.consume(bytes.size());
            read();
        });
    }

    void write() {
        stream.async_write(asio::buffer(outbox.front()), [this, self = shared_from_this()](error_code error, size_t) {
            if (error || state == State::closed) return; // the reader meets the same error, and tells it
            outbox.pop_front();
            if (!outbox.empty()) write();
        });
    }

    // Works until `done` or the time is over.
    template <class Done>
    void work(std::chrono::milliseconds time, Done done) {
        const auto deadline = std::chrono::steady_clock::now() + time;
        io.poll_one(); // a deadline of now still makes progress
        while (!done() && !io.stopped() && io.run_one_until(deadline) > 0) {
        }
    }
};

Connection::Connection(Endpoint endpoint, std::chrono::milliseconds timeout)
    : Connection(std::move(endpoint), timeout, Loop()) {
    shared_ = false;
}

Connection::Connection(Endpoint endpoint, std::chrono::milliseconds timeout, const Loop& loop)
    : io_(loop.io_), socket_(std::make_shared<Socket>(std::move(endpoint), timeout, *io_)), shared_(true) {
    if (io_->context.stopped()) io_->context.restart(); // every socket before this one is closed
    socket_->resolve();
}

Connection::~Connection() {
    if (socket_) socket_->closedNow("dropped by this client");
}

Connection::Connection(Connection&&) noexcept = default;

Connection& Connection::operator=(Connection&& other) noexcept {
    std::swap(io_, other.io_); // what was here closes with `other`
    std::swap(socket_, other.socket_);
    std::swap(shared_, other.shared_);
    return *this;
}

const Endpoint& Connection::endpoint() const { return socket_->endpoint; }
Connection::State Connection::state() const { return socket_->state; }
const std::string& Connection::closedBecause() const { return socket_->closed_because; }
bool Connection::refused() const { return socket_->refused; }
size_t Connection::unsent() const { return socket_->outbox.size(); }

std::optional<Bytes> Connection::receive(std::chrono::milliseconds timeout) {
    Socket& socket = *socket_;
    const State before = socket.state;
    const bool only_look = shared_ && timeout.count() <= 0;
    if (!only_look && socket.inbox.empty() && before != State::closed)
        socket.work(timeout, [&] { return !socket.inbox.empty() || socket.state != before; });
    if (socket.inbox.empty()) return {};
    Bytes message = std::move(socket.inbox.front());
    socket.inbox.pop_front();
    return message;
}

void Connection::send(std::span<const uint8_t> message) {
    Socket& socket = *socket_;
    if (socket.state != State::open) return;
    if (socket.outbox.size() >= kMaxUnsent) return socket.closedNow("the server does not read what it is sent");
    socket.outbox.emplace_back(message.begin(), message.end());
    if (socket.outbox.size() == 1) socket.write();
}

void Connection::close(std::chrono::milliseconds deadline) {
    Socket& socket = *socket_;
    if (socket.state == State::open) {
        const auto start = std::chrono::steady_clock::now();
        socket.work(deadline, [&] { return socket.outbox.empty() || socket.state == State::closed; });
        const auto spent =
            std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start);
        // Frames that are on their way are read and dropped until the server's half of the handshake comes.
        if (socket.state == State::open) {
            socket.stream.async_close(websocket::close_code::normal,
                                      [self = socket_](error_code) { self->parted = true; });
            socket.work(deadline - spent, [&] { return socket.parted; });
        }
    }
    socket.closedNow("closed by this client");
    socket.work(std::chrono::milliseconds(0), [] { return false; });
}

void Connection::vanish() {
    error_code ignored; // the socket may be gone already
    auto& tcp_socket = socket_->stream.next_layer().tcp().socket();
    tcp_socket.set_option(asio::socket_base::linger(true, 0), ignored);
    socket_->closedNow("dropped by this client");
    socket_->work(std::chrono::milliseconds(0), [] { return false; });
}

} // namespace brume::client

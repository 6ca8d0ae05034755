// One WebSocket to a server: whole binary messages in and out, nothing known of what they mean. One thread, no callbacks.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/native/endpoint.h"

namespace brume::client {

using Bytes = std::vector<uint8_t>;

// What works on sockets. Connections may share one, so that a single thread waits for all of them.
class Loop {
public:
    Loop();
    // Works on all sockets until one of them has moved or the time is over; at once when none is open.
    void wait(std::chrono::microseconds timeout);

private:
    friend class Connection;
    struct Io;
    std::shared_ptr<Io> io_;
};

class Connection {
public:
    enum class State { connecting, open, closed };

    // Starts to connect; receive() drives it. Resolving, connecting and the handshake get `timeout` each.
    Connection(Endpoint endpoint, std::chrono::milliseconds timeout);
    // The same in a loop that others share: its wait() drives it too, and receive() with a timeout of 0 only looks.
    Connection(Endpoint endpoint, std::chrono::milliseconds timeout, const Loop& loop);
    ~Connection(); // drops the socket: close() first to part politely
    Connection(Connection&&) noexcept;
    Connection& operator=(Connection&&) noexcept;

    const Endpoint& endpoint() const;
    State state() const;
    // Why it is closed, in one line; empty before.
    const std::string& closedBecause() const;
    // It is closed for what another try will not change: a token, a certificate, the protocol's version.
    bool refused() const;

    // Works on the socket until a message is there, the state changes or the time is over.
    std::optional<Bytes> receive(std::chrono::milliseconds timeout);

    // Queues a message; ignored unless open. A server that reads nothing closes the connection after kMaxUnsent messages.
    void send(std::span<const uint8_t> message);
    // Messages that the socket has not taken yet.
    size_t unsent() const;

    // Sends what is queued and the closing handshake, waiting for the server's at most `deadline`.
    void close(std::chrono::milliseconds deadline);
    // Resets the TCP connection without a goodbye, as a machine does that loses power.
    void vanish();

    static constexpr size_t kMaxUnsent = 4096;
    static constexpr size_t kMaxMessageBytes = 64u << 20; // two views of 8192 x 8192 at a high quality fit

private:
    struct Socket;
    std::shared_ptr<Loop::Io> io_; // before the socket, which lives in it
    std::shared_ptr<Socket> socket_;
    bool shared_ = false;
};

} // namespace brume::client

// One WebSocket to a server: sends and receives whole binary messages, whatever they mean. For one thread; no
// callbacks.
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

// An event loop of sockets. Connections may share one, so that a single thread waits for all of them.
class Loop {
public:
    Loop();
    // Runs the sockets until one has an event or the time is over; returns at once when none is open.
    void wait(std::chrono::microseconds timeout);

private:
    friend class Connection;
    struct Io;
    std::shared_ptr<Io> io_;
};

class Connection {
public:
    enum class State { connecting, open, closed };

    // Starts to connect; receive() runs it. Resolving, connecting and the handshake get `timeout` each.
    Connection(Endpoint endpoint, std::chrono::milliseconds timeout);
    // Likewise, in a loop that others share: Loop::wait() runs it too, and receive() with a timeout of 0 does not
    // wait.
    Connection(Endpoint endpoint, std::chrono::milliseconds timeout, const Loop& loop);
    ~Connection(); // drops the socket without a closing handshake; close() makes one
    Connection(Connection&&) noexcept;
    Connection& operator=(Connection&&) noexcept;

    const Endpoint& endpoint() const;
    State state() const;
    // Why it is closed, in one line; empty before.
    const std::string& closedBecause() const;
    // True if it closed for a reason that another try will not change: the token, the certificate, the protocol's
    // version.
    bool refused() const;

    // Runs the socket until a message has come, the state changes or the time is over. Nothing without a message.
    std::optional<Bytes> receive(std::chrono::milliseconds timeout);

    // Queues a message; ignored unless open. A server that reads nothing closes the connection after kMaxUnsent
    // messages.
    void send(std::span<const uint8_t> message);
    // Messages that the socket has not taken yet.
    size_t unsent() const;

    // Sends what is queued and the closing handshake, waiting for the server's at most `deadline`.
    void close(std::chrono::milliseconds deadline);
    // Resets the TCP connection without a goodbye: to the server, a machine that lost its power.
    void vanish();

    static constexpr size_t kMaxUnsent = 4096;
    static constexpr size_t kMaxMessageBytes = 64u << 20; // two views of 8192 x 8192 at a high quality fit

private:
    struct Socket;
    std::shared_ptr<Loop::Io> io_; // declared before the socket, which must be destroyed first
    std::shared_ptr<Socket> socket_;
    bool shared_ = false; // true: other connections use the loop too
};

} // namespace brume::client

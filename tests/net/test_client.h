// A client that can also break the protocol: blocking sockets with deadlines, HTTP and WebSocket written by hand.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/message.h"

namespace brume::test {

using namespace std::chrono_literals;
using Milliseconds = std::chrono::milliseconds;

class Socket {
public:
    // Connects to 127.0.0.1. `receive_buffer`: bytes; 0: the system's default.
    explicit Socket(uint16_t port, int receive_buffer = 0);
    ~Socket();
    Socket(const Socket&) = delete;
    Socket& operator=(const Socket&) = delete;

    // Sends all bytes. False if the peer is gone or takes nothing for `timeout`.
    bool send(std::span<const uint8_t> bytes, Milliseconds timeout = 5s) const;
    bool send(std::string_view text, Milliseconds timeout = 5s) const;
    // Reads exactly `bytes` bytes; fewer if the peer closes or nothing more comes in time.
    std::string read(size_t bytes, Milliseconds timeout = 5s);
    // Reads up to and including `end`; less if the peer closes or nothing more comes in time.
    std::string readUntil(std::string_view end, Milliseconds timeout = 5s);
    // Reads everything until the peer closes.
    std::string readAll(Milliseconds timeout = 5s);
    // True if the peer closes or resets within the time, whatever it sends before.
    bool closesWithin(Milliseconds timeout);
    void reset(); // drops the connection with a TCP reset

private:
    bool fill(std::chrono::steady_clock::time_point deadline); // reads some into pending_
    int fd_ = -1;
    bool eof_ = false;
    std::string pending_;
};

struct HttpAnswer {
    int status = 0;
    std::string head, body;
    std::string header(const std::string& name) const; // the name in any case; "" if missing
};

// Reads one answer. It has a Content-Length, or no body (HEAD and 304).
HttpAnswer readAnswer(Socket& socket, bool head_only = false, Milliseconds timeout = 5s);
// Sends one request on a new connection and reads the answer.
HttpAnswer get(uint16_t port, const std::string& target, const std::string& extra_headers = "",
               const std::string& method = "GET");

// One WebSocket message.
struct Received {
    uint8_t opcode = 0; // 1 text, 2 binary, 8 close, 9 ping
    std::vector<uint8_t> bytes;
    std::optional<wire::Parsed> parsed; // of a binary message; points into `bytes`
    uint16_t closeCode() const { return bytes.size() < 2 ? 0 : uint16_t(bytes[0] << 8 | bytes[1]); }
};

class WsClient {
public:
    // Connects and upgrades at `path`. `headers`: sent in place of "Sec-WebSocket-Protocol: brume.v1\r\n"; `before`:
    // sent before all else.
    explicit WsClient(uint16_t port, int receive_buffer = 0,
                      const std::string& headers = "Sec-WebSocket-Protocol: brume.v1\r\n",
                      const std::string& before = {}, const std::string& path = "/ws");

    HttpAnswer handshake;
    Socket socket;
    bool answer_pings = true;

    bool sendMessage(uint8_t opcode, std::span<const uint8_t> payload, Milliseconds timeout = 5s) const;
    template <class Build>
    bool say(Build&& build) {
        const wire::Packed packed = wire::pack(build);
        return sendMessage(2, wire::bytesOf(packed));
    }
    bool hello(uint16_t width = 640, uint16_t height = 360, uint8_t views = 1);
    bool pose(uint32_t seq, wire::Vec3 position = {0, 0, 10}, uint16_t width = 0, uint16_t height = 0,
              bool hidden = false);
    bool ack(uint32_t frame);

    // The next message; null if none comes in time or the connection has ended. Pings are answered and left out.
    std::unique_ptr<Received> receive(Milliseconds timeout = 5s);
    // The next message of type T, others are skipped; null if none comes in time.
    template <class T>
    std::unique_ptr<Received> next(Milliseconds timeout = 5s) {
        const auto deadline = std::chrono::steady_clock::now() + timeout;
        for (;;) {
            const auto left = std::chrono::duration_cast<Milliseconds>(deadline - std::chrono::steady_clock::now());
            auto message = left > 0ms ? receive(left) : nullptr;
            if (!message || (message->parsed && message->parsed->as<T>())) return message;
        }
    }
    // The code of the next close frame, other messages are skipped; 0 if none comes in time.
    uint16_t closeCode(Milliseconds timeout = 5s);
};

} // namespace brume::test

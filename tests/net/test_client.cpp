#include "tests/net/test_client.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

namespace brume::test {
namespace {

using SteadyClock = std::chrono::steady_clock;

bool ready(int fd, short events, SteadyClock::time_point deadline) {
    const auto left = std::chrono::duration_cast<Milliseconds>(deadline - SteadyClock::now()).count();
    pollfd wait{fd, events, 0};
    return poll(&wait, 1, int(std::max<int64_t>(left, 0))) > 0;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

} // namespace

Socket::Socket(uint16_t port, int receive_buffer) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    if (receive_buffer > 0) setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof(receive_buffer));
    const int on = 1;
    setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0)
        throw std::runtime_error(fmt::format("cannot connect to port {}: {}", port, std::strerror(errno)));
}

Socket::~Socket() {
    if (fd_ >= 0) close(fd_);
}

bool Socket::send(std::span<const uint8_t> bytes, Milliseconds timeout) const {
    while (!bytes.empty()) {
        if (!ready(fd_, POLLOUT, SteadyClock::now() + timeout)) return false;
        const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent < 0 && errno == EAGAIN) continue;
        if (sent < 0) return false;
        bytes = bytes.subspan(size_t(sent));
    }
    return true;
}

bool Socket::send(std::string_view text, Milliseconds timeout) const {
    return send({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, timeout);
}

bool Socket::fill(SteadyClock::time_point deadline) {
    if (eof_ || !ready(fd_, POLLIN, deadline)) return false;
    std::array<char, 65536> buffer;
    const ssize_t got = recv(fd_, buffer.data(), buffer.size(), 0);
    if (got <= 0) {
        eof_ = true;
        return false;
    }
    pending_.append(buffer.data(), size_t(got));
    return true;
}

std::string Socket::read(size_t bytes, Milliseconds timeout) {
    const auto deadline = SteadyClock::now() + timeout;
    while (pending_.size() < bytes && fill(deadline)) {
    }
    std::string out = pending_.substr(0, bytes);
    pending_.erase(0, out.size());
    return out;
}

std::string Socket::readUntil(std::string_view end, Milliseconds timeout) {
    const auto deadline = SteadyClock::now() + timeout;
    size_t found;
    while ((found = pending_.find(end)) == pending_.npos && fill(deadline)) {
    }
    return read(found == pending_.npos ? pending_.size() : found + end.size(), 0ms);
}

std::string Socket::readAll(Milliseconds timeout) {
    const auto deadline = SteadyClock::now() + timeout;
    while (fill(deadline)) {
    }
    return std::move(pending_);
}

bool Socket::closesWithin(Milliseconds timeout) {
    const auto deadline = SteadyClock::now() + timeout;
    while (fill(deadline)) pending_.clear();
    return eof_;
}

void Socket::reset() {
    const linger now{1, 0};
    setsockopt(fd_, SOL_SOCKET, SO_LINGER, &now, sizeof(now));
    close(fd_);
    fd_ = -1;
    eof_ = true;
}

std::string HttpAnswer::header(const std::string& name) const {
    const std::string all = lower(head), wanted = "\r\n" + lower(name) + ": ";
    const size_t at = all.find(wanted);
    if (at == all.npos) return "";
    const size_t begin = at + wanted.size();
    return head.substr(begin, head.find("\r\n", begin) - begin);
}

HttpAnswer readAnswer(Socket& socket, bool head_only, Milliseconds timeout) {
    HttpAnswer answer;
    answer.head = socket.readUntil("\r\n\r\n", timeout);
    if (answer.head.size() < 12) return answer;
    answer.status = std::stoi(answer.head.substr(9, 3));
    const std::string length = answer.header("Content-Length");
    if (!head_only && !length.empty()) answer.body = socket.read(std::stoul(length), timeout);
    return answer;
}

HttpAnswer get(uint16_t port, const std::string& target, const std::string& extra_headers, const std::string& method) {
    Socket socket(port);
    socket.send(fmt::format("{} {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}\r\n", method, target, port, extra_headers));
    return readAnswer(socket, method == "HEAD", 10s);
}

WsClient::WsClient(uint16_t port, int receive_buffer, const std::string& headers, const std::string& before,
                   const std::string& path)
    : socket(port, receive_buffer) {
    socket.send(before);
    socket.send(fmt::format("GET {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n{}\r\n",
                            path, port, headers));
    handshake = readAnswer(socket);
}

bool WsClient::sendMessage(uint8_t opcode, std::span<const uint8_t> payload, Milliseconds timeout) const {
    std::vector<uint8_t> frame{uint8_t(0x80 | opcode)};
    if (payload.size() < 126) {
        frame.push_back(uint8_t(0x80 | payload.size()));
    } else if (payload.size() < 65536) {
        frame.insert(frame.end(), {0x80 | 126, uint8_t(payload.size() >> 8), uint8_t(payload.size())});
    } else {
        frame.push_back(0x80 | 127);
        for (int shift = 56; shift >= 0; shift -= 8) frame.push_back(uint8_t(uint64_t(payload.size()) >> shift));
    }
    const std::array<uint8_t, 4> mask{0x12, 0x34, 0x56, 0x78};
    frame.insert(frame.end(), mask.begin(), mask.end());
    for (size_t i = 0; i < payload.size(); ++i) frame.push_back(payload[i] ^ mask[i % 4]);
    return socket.send(frame, timeout);
}

bool WsClient::hello(uint16_t width, uint16_t height, uint8_t views) {
    return say([&](auto& b) { return wire::CreateHelloDirect(b, "test client", width, height, views); });
}

bool WsClient::pose(uint32_t seq, wire::Vec3 position, uint16_t width, uint16_t height, bool hidden) {
    const wire::Quat orientation(0, 0, 0, 1);
    return say([&](auto& b) {
        return wire::CreatePose(b, seq, 1000 + seq, &position, &orientation, 0.8f, 0, width, height, nullptr, nullptr,
                                hidden);
    });
}

bool WsClient::ack(uint32_t frame) {
    return say([&](auto& b) { return wire::CreateAck(b, frame); });
}

std::unique_ptr<Received> WsClient::receive(Milliseconds timeout) {
    const auto deadline = SteadyClock::now() + timeout;
    for (;;) {
        const auto left = [&] {
            return std::max(std::chrono::duration_cast<Milliseconds>(deadline - SteadyClock::now()), 0ms);
        };
        const std::string head = socket.read(2, left());
        if (head.size() < 2) return nullptr;
        uint64_t size = uint8_t(head[1]) & 0x7f;
        if (size >= 126) {
            const size_t bytes = size == 126 ? 2 : 8;
            const std::string extended = socket.read(bytes, left());
            if (extended.size() < bytes) return nullptr;
            size = 0;
            for (const char c : extended) size = size << 8 | uint8_t(c);
        }
        const std::string payload = socket.read(size, left());
        if (payload.size() < size) return nullptr;
        auto received = std::make_unique<Received>();
        received->opcode = uint8_t(head[0]) & 0x0f;
        received->bytes.assign(payload.begin(), payload.end());
        if (received->opcode == 9) {
            if (answer_pings) sendMessage(10, received->bytes);
            continue;
        }
        if (received->opcode == 2) received->parsed = wire::parse(received->bytes);
        return received;
    }
}

uint16_t WsClient::closeCode(Milliseconds timeout) {
    const auto deadline = SteadyClock::now() + timeout;
    for (;;) {
        const auto left = std::chrono::duration_cast<Milliseconds>(deadline - SteadyClock::now());
        const auto message = left > 0ms ? receive(left) : nullptr;
        if (!message) return 0;
        if (message->opcode == 8) {
            sendMessage(8, message->bytes); // the other half of the closing handshake
            return message->closeCode();
        }
    }
}

} // namespace brume::test

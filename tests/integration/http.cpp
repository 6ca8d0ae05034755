#include "tests/integration/http.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace brume::test {

HttpConnection::HttpConnection(uint16_t port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    timeval patience{};
    patience.tv_sec = std::chrono::duration_cast<std::chrono::seconds>(kPatience).count();
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        close(fd_);
        throw std::runtime_error("cannot connect to port " + std::to_string(port));
    }
}

HttpConnection::~HttpConnection() { close(fd_); }

void HttpConnection::send(const std::string& text) const {
    if (::send(fd_, text.data(), text.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(text.size()))
        throw std::runtime_error("the server does not take the request");
}

bool HttpConnection::fill() {
    std::array<char, 65536> bytes;
    const ssize_t size = recv(fd_, bytes.data(), bytes.size(), 0);
    if (size < 0) throw std::runtime_error("nothing more came from the server");
    buffer_.append(bytes.data(), static_cast<size_t>(size));
    return size > 0;
}

std::string HttpConnection::readBytes(size_t count) {
    while (buffer_.size() < count)
        if (!fill()) throw std::runtime_error("the server closed in the middle of a body");
    std::string bytes = buffer_.substr(0, count);
    buffer_.erase(0, count);
    return bytes;
}

std::string HttpConnection::readLine() {
    size_t end;
    while ((end = buffer_.find("\r\n")) == buffer_.npos)
        if (!fill()) throw std::runtime_error("the server closed in the middle of a line");
    std::string line = buffer_.substr(0, end);
    buffer_.erase(0, end + 2);
    return line;
}

HttpReply HttpConnection::readHead() {
    HttpReply reply;
    const std::string status = readLine();
    if (!status.starts_with("HTTP/1.1 ")) throw std::runtime_error("not HTTP: " + status);
    reply.status = std::stoi(status.substr(9));
    for (std::string line = readLine(); !line.empty(); line = readLine()) {
        const size_t colon = line.find(": ");
        if (colon == line.npos) throw std::runtime_error("not a header: " + line);
        std::string name = line.substr(0, colon);
        std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
        reply.headers[name] = line.substr(colon + 2);
    }
    return reply;
}

HttpReply HttpConnection::readReply() {
    HttpReply reply = readHead();
    reply.body = readBytes(std::stoul(reply.headers.at("content-length")));
    return reply;
}

HttpReply get(uint16_t port, const std::string& target) {
    HttpConnection connection(port);
    connection.send("GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                    "\r\nConnection: close\r\n\r\n");
    return connection.readReply();
}

std::optional<double> metric(uint16_t port, const std::string& name) {
    const std::string text = "\n" + get(port, "/metrics").body;
    const size_t at = text.find("\n" + name + " ");
    if (at == text.npos) return {};
    return std::stod(text.substr(at + name.size() + 2));
}

} // namespace brume::test

// An HTTP client over a plain socket, written by hand: tests judge the server's bytes without the library that the
// server uses.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "tests/integration/process.h"

namespace brume::test {

struct HttpReply {
    int status = 0;
    std::map<std::string, std::string> headers; // names in lower case
    std::string body;
};

// A connection to a port of this machine. Throws std::runtime_error if it fails, or if nothing comes for kPatience.
class HttpConnection {
public:
    explicit HttpConnection(uint16_t port);
    ~HttpConnection();
    HttpConnection(const HttpConnection&) = delete;
    HttpConnection& operator=(const HttpConnection&) = delete;

    void send(const std::string& text) const;
    // Reads status line and headers.
    HttpReply readHead();
    // Reads a reply with a Content-Length.
    HttpReply readReply();
    std::string readBytes(size_t count);
    std::string readLine(); // without CR LF

private:
    bool fill(); // reads more bytes; false at the end of the stream

    int fd_;
    std::string buffer_;
};

HttpReply get(uint16_t port, const std::string& target);

// The value of one time series of /metrics; nothing if it is missing.
std::optional<double> metric(uint16_t port, const std::string& name);

} // namespace brume::test

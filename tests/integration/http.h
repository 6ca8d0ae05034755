// HTTP over a plain socket, written out by hand, so that the server is judged by its bytes and not by the library it is made
// with.
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

// One connection to a port of this machine. Throws std::runtime_error when it fails or nothing comes for kPatience.
class HttpConnection {
public:
    explicit HttpConnection(uint16_t port);
    ~HttpConnection();
    HttpConnection(const HttpConnection&) = delete;
    HttpConnection& operator=(const HttpConnection&) = delete;

    void send(const std::string& text) const;
    // Status line and headers.
    HttpReply readHead();
    // A reply whose body has a Content-Length.
    HttpReply readReply();
    std::string readBytes(size_t count);
    std::string readLine(); // without its CR LF

private:
    bool fill(); // false at the end of the stream

    int fd_;
    std::string buffer_;
};

HttpReply get(uint16_t port, const std::string& target);

// The value of one time series of /metrics; nothing when it is not there.
std::optional<double> metric(uint16_t port, const std::string& name);

} // namespace brume::test

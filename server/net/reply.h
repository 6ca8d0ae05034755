// An HTTP reply as plain data.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace brume::net {

struct Reply {
    unsigned status = 200;
    std::string content_type = "text/plain; charset=utf-8";
    std::string body;
    std::vector<std::pair<std::string, std::string>> headers; // besides content type and length
    bool for_all = false;                                     // true: pages of every site may have it
    bool close = false;                                       // true: the connection ends after the reply
};

// A reply whose body is one line of text.
inline Reply lineReply(unsigned status, std::string line) {
    Reply reply;
    reply.status = status;
    reply.body = std::move(line) + "\n";
    return reply;
}

// All connections are taken.
inline Reply noRoom() {
    Reply reply = lineReply(503, "too many connections: try again later");
    reply.headers = {{"Retry-After", "5"}};
    return reply;
}

// One address comes faster than it may.
inline Reply tooOften() {
    Reply reply = lineReply(429, "too many connections a second: try again later");
    reply.headers = {{"Retry-After", "1"}};
    return reply;
}

} // namespace brume::net

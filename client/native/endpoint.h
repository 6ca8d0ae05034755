// Where a server is, as a user writes it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace brume::client {

struct Endpoint {
    std::string host; // name or address, without the brackets of IPv6
    uint16_t port = 8080;
    std::string path = "/ws";

    std::string url() const; // ws://host:port/path
};

// "ws://host", "ws://host:port" or "ws://[address]:port/path". Throws std::invalid_argument: one line that says what is allowed.
Endpoint parseUrl(std::string_view url);

} // namespace brume::client

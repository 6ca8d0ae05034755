// Where a server is, as a user writes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace brume::client {

struct Endpoint {
    std::string host; // name or address, without the brackets of IPv6
    uint16_t port = 8080;
    std::string path = "/ws";
    bool tls = false;
    std::string token; // what lets us in; empty: none
    std::string ca;    // PEM file of who vouches for the server; empty: whom the system trusts

    std::string url() const; // ws://host:port/path or wss://..., without the token
};

// "ws://host", "ws://host:port" or "ws://[address]:port/path"; so with wss. Throws std::invalid_argument: one line that says what
// is allowed.
Endpoint parseUrl(std::string_view url);

// The server that a goodbye's `go_to` names, by the URL of its socket (ws, wss) or of the page beside it (http, https); without a
// port 80 or 443, as in a browser. Nothing for any other text.
std::optional<Endpoint> parseGoTo(std::string_view url);

// The token in a file, or without one in BRUME_TOKEN; empty when there is neither. Space around it is not part of it. Throws
// std::invalid_argument, one line, when the file cannot be read or holds something else.
std::string readToken(const std::string& file);

} // namespace brume::client

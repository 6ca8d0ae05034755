// The address of a server, as a user writes it.
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
    std::string token; // proves to the server who we are (docs/security.md); empty: none
    std::string ca;    // PEM file of the certificates that may sign the server's; empty: those that the system trusts

    std::string authority() const; // host:port, an address of IPv6 in brackets: what a Host header has
    std::string url() const;       // ws://host:port/path or wss://..., without the token
};

// Reads "ws://host", "ws://host:port" or "ws://[address]:port/path", or the same with wss; or the page
// beside the socket as parseGoTo() does. Throws std::invalid_argument: one line that says what is allowed.
Endpoint parseUrl(std::string_view url);

// The server that a goodbye's `go_to` names: the URL of its socket (ws, wss), or of the page beside the socket (http,
// https). Without a port it is 80 or 443, as in a browser. Nothing for any other text.
std::optional<Endpoint> parseGoTo(std::string_view url);

// The token in this file, or in the environment's BRUME_TOKEN if `file` is empty; empty if neither exists. Spaces
// around it are removed. Throws std::invalid_argument, one line, if the file cannot be read or holds something else.
std::string readToken(const std::string& file);

} // namespace brume::client

#include "client/native/endpoint.h"

#include <charconv>
#include <stdexcept>

namespace brume::client {
namespace {

[[noreturn]] void refuse(std::string_view url, const std::string& why) {
    throw std::invalid_argument("bad url '" + std::string(url) + "': " + why + "; write ws://host:port");
}

uint16_t parsePort(std::string_view url, std::string_view text) {
    uint32_t port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (error != std::errc{} || end != text.data() + text.size() || port < 1 || port > 65535)
        refuse(url, "the port is a number from 1 to 65535");
    return static_cast<uint16_t>(port);
}

} // namespace

std::string Endpoint::url() const {
    const bool ipv6 = host.find(':') != std::string::npos;
    return "ws://" + (ipv6 ? "[" + host + "]" : host) + ":" + std::to_string(port) + path;
}

Endpoint parseUrl(std::string_view url) {
    constexpr std::string_view scheme = "ws://";
    if (!url.starts_with(scheme)) refuse(url, "only ws:// is spoken");
    for (const char c : url)
        if (c <= ' ' || c > '~') refuse(url, "it has a space or a character that is not ASCII");

    std::string_view rest = url.substr(scheme.size());
    Endpoint endpoint;
    if (const size_t slash = rest.find('/'); slash != rest.npos) {
        if (rest.size() > slash + 1) endpoint.path = rest.substr(slash);
        rest = rest.substr(0, slash);
    }

    if (rest.starts_with('[')) {
        const size_t bracket = rest.find(']');
        if (bracket == rest.npos) refuse(url, "']' is missing");
        endpoint.host = rest.substr(1, bracket - 1);
        rest = rest.substr(bracket + 1);
        if (!rest.empty() && rest[0] != ':') refuse(url, "only ':port' may follow ']'");
        if (!rest.empty()) endpoint.port = parsePort(url, rest.substr(1));
    } else {
        const size_t colon = rest.find(':');
        endpoint.host = rest.substr(0, colon);
        if (colon != rest.npos) endpoint.port = parsePort(url, rest.substr(colon + 1));
    }
    if (endpoint.host.empty()) refuse(url, "the host is missing");
    return endpoint;
}

} // namespace brume::client

#include "client/native/endpoint.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace brume::client {
namespace {

constexpr size_t kMostTokenBytes = 512; // server/net/token.h

[[noreturn]] void refuse(std::string_view url, const std::string& why) {
    throw std::invalid_argument("bad url '" + std::string(url) + "': " + why +
                                "; write ws://host:port, wss://host:port or the page's address");
}

uint16_t parsePort(std::string_view url, std::string_view text) {
    uint32_t port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (error != std::errc{} || end != text.data() + text.size() || port < 1 || port > 65535)
        refuse(url, "the port is a number from 1 to 65535");
    return static_cast<uint16_t>(port);
}

Endpoint parse(std::string_view url, uint16_t default_port) {
    const bool tls = url.starts_with("wss://");
    if (!tls && !url.starts_with("ws://")) refuse(url, "only ws:// and wss:// are spoken");
    for (const char c : url)
        if (c <= ' ' || c > '~') refuse(url, "it has a space or a character that is not ASCII");

    std::string_view rest = url.substr(tls ? 6 : 5);
    Endpoint endpoint;
    endpoint.port = default_port;
    endpoint.tls = tls;
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

bool isPage(std::string_view url) { return url.starts_with("http"); }

// The URL of a socket or of the page beside it; without a port 80 or 443.
Endpoint parseLikeBrowser(std::string_view url) {
    std::string socket(url.substr(0, url.find_first_of("?#")));
    if (isPage(url)) socket.replace(0, 4, "ws");
    Endpoint endpoint = parse(socket, socket.starts_with("wss:") ? 443 : 80);
    if (!isPage(url)) return endpoint;
    // A last part without a dot is a folder whose slash was left out: https://host/clouds/brume.
    const std::string last = endpoint.path.substr(endpoint.path.rfind('/') + 1);
    if (!last.empty() && last != "ws" && last.find('.') == last.npos) endpoint.path += '/';
    endpoint.path.replace(endpoint.path.rfind('/') + 1, std::string::npos, "ws");
    return endpoint;
}

} // namespace

std::string Endpoint::authority() const {
    const bool ipv6 = host.find(':') != std::string::npos;
    return (ipv6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

std::string Endpoint::url() const { return (tls ? "wss://" : "ws://") + authority() + path; }

Endpoint parseUrl(std::string_view url) { return isPage(url) ? parseLikeBrowser(url) : parse(url, Endpoint{}.port); }

std::optional<Endpoint> parseGoTo(std::string_view url) {
    try {
        return parseLikeBrowser(url);
    } catch (const std::invalid_argument&) {
        return {};
    }
}

std::string readToken(const std::string& file) {
    const char* const given = std::getenv("BRUME_TOKEN");
    std::string token = given ? given : "";
    if (!file.empty()) {
        std::ifstream in(file);
        if (!in) throw std::invalid_argument("--token-file: cannot read '" + file + "'");
        token.resize(kMostTokenBytes + 64);
        in.read(token.data(), std::streamsize(token.size()));
        token.resize(size_t(in.gcount()));
    }
    constexpr std::string_view space = " \t\r\n";
    token.erase(0, std::min(token.find_first_not_of(space), token.size()));
    token.erase(token.find_last_not_of(space) + 1); // npos + 1 is 0
    for (const char c : token)
        if (c <= ' ' || c > '~' || token.size() > kMostTokenBytes)
            throw std::invalid_argument((file.empty() ? "BRUME_TOKEN" : "'" + file + "'") + " holds no token");
    if (!file.empty() && token.empty()) throw std::invalid_argument("'" + file + "' holds no token");
    return token;
}

} // namespace brume::client

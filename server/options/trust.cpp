#include <algorithm>
#include <chrono>
#include <stdexcept>

#include <fmt/format.h>

#include "protocol/net/address.h"
#include "server/net/rooms.h"
#include "server/net/token.h"
#include "server/net/token_key.h"
#include "server/options/groups.h"

namespace brume {
namespace {

std::string checkName(const std::string& name) {
    const bool printable = std::all_of(name.begin(), name.end(), [](char c) { return c >= ' ' && c <= '~'; });
    return printable && name.size() <= net::kMostTokenName ? "" : "allowed: 64 printable ASCII characters";
}

std::string checkTokenRoom(const std::string& name) {
    return net::isRoomName(name)
               ? ""
               : fmt::format("allowed: a room's name, 1 to {} letters, digits, '-' and '_'", net::kMostRoomName);
}

} // namespace

void addTrustOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Trust");
    g.option("--token-key", o.token_key, "file with the secret of tokens: what a viewer may do is in its token")
        .unit("FILE");
    g.flag("--open", o.open, "without a key let other machines in: everyone who comes may do everything");
    g.option("--tls-certificate", o.net.tls_certificate, "certificate chain for TLS, PEM; with --tls-key").unit("FILE");
    g.option("--tls-key", o.net.tls_key, "its private key, PEM").unit("FILE");
}

void readTrust(ServerOptions& o) {
    if (!o.token_key.empty()) o.net.token_key = readTokenKey(o.token_key);
    if (o.net.tls_certificate.empty() != o.net.tls_key.empty())
        throw std::runtime_error("--tls-certificate and --tls-key belong together: give both, or neither");
    if (o.net.token_key.empty() && !o.open && !isLoopback(o.net.listen))
        throw std::runtime_error(
            fmt::format("--listen {}: other machines could do everything here; allowed: --token-key FILE for "
                        "viewers with tokens, or --open for whoever comes",
                        o.net.listen));
    if (o.net.token_key.empty() && !o.open && o.net.proxy_protocol)
        throw std::runtime_error("--proxy-protocol: who comes through the gateway could do everything here; allowed: "
                                 "--token-key FILE for viewers with tokens, or --open for whoever comes");
    o.net.trusted_proxies.clear();
    for (const std::string& text : o.trusted_proxies) o.net.trusted_proxies.push_back(*net::Network::read(text));
    if (o.net.token_key.empty() && !o.open && !o.trusted_proxies.empty())
        throw std::runtime_error("--trusted-proxy: who comes through the proxy could do everything here; allowed: "
                                 "--token-key FILE for viewers with tokens, or --open for whoever comes");
    if (!o.net.token_key.empty() && o.open)
        throw std::runtime_error("--open lets everyone in, --token-key does not: give one of them");
}

void addTokenOptions(OptionTable& table, TokenRequest& request) {
    OptionGroup g(table, nullptr);
    const NewOption make =
        g.option("--make-token", request.role, "print a token of this role, made with --token-key, and end")
            .flagOnly()
            .oneOf({"viewer", "pusher", "controller", "presenter", "operator"})
            .unit("ROLE");
    g.option("--valid-for", request.valid_s, "of that token")
        .flagOnly()
        .needs(make)
        .range(1u, uint32_t(net::kLongestToken.count()))
        .unit("SECONDS");
    g.option("--token-name", request.name, "whose that token is, for the log").flagOnly().needs(make).check(checkName);
    g.option("--token-room", request.room, "the room that it is good in, and nowhere else; without it in all")
        .flagOnly()
        .needs(make)
        .check(checkTokenRoom)
        .unit("NAME");
}

std::string makeToken(const TokenRequest& request, const std::string& key) {
    if (key.empty()) throw std::runtime_error("--make-token needs --token-key FILE, the server's");
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    return net::makeToken({.role = *net::roleNamed(request.role),
                           .expires = now + std::chrono::seconds(request.valid_s),
                           .name = request.name,
                           .room = request.room},
                          key);
}

} // namespace brume

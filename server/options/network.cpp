#include <algorithm>
#include <cctype>
#include <string_view>

#include "server/options/groups.h"

namespace brume {
namespace {

std::string checkHost(const std::string& name) {
    const bool plain = std::all_of(name.begin(), name.end(),
                                   [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '.' || c == '_'; });
    return plain && name.size() <= 253 ? "" : "allowed: a host name without scheme and port, such as clouds.example";
}

// As browsers send it: scheme, host, and a port that is not the scheme's own. It ends up in a header of the page's
// replies, among others.
std::string checkOrigin(const std::string& origin) {
    if (origin == "*") return "";
    bool plain = false;
    for (const std::string_view scheme : {"http://", "https://"})
        if (origin.starts_with(scheme)) {
            const std::string_view host = std::string_view(origin).substr(scheme.size());
            plain = !host.empty() && std::ranges::all_of(host, [](unsigned char c) {
                return std::isalnum(c) || std::string_view("-._:[]").find(char(c)) != std::string_view::npos;
            });
        }
    return plain ? "" : "allowed: an origin such as https://clouds.example or http://127.0.0.1:8000, no path, or *";
}

std::string checkNetworkText(const std::string& text) {
    return net::Network::read(text) ? "" : "allowed: an address or a network, such as 127.0.0.1, ::1 or 10.0.0.0/8";
}

} // namespace

void addNetworkOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Network");
    g.option("--listen", o.net.listen, "address; 0.0.0.0 or :: lets other machines in");
    g.option("--port", o.net.port, "0 takes a free one").range(0, 65535);
    g.flag("--proxy-protocol", o.net.proxy_protocol,
           "a gateway says first whose connection it passes on, by the PROXY protocol; who does not is refused");
    g.several("--trusted-proxy", o.trusted_proxies, ',',
              "a proxy's address, or network such as 10.0.0.0/8: its X-Forwarded-For says whose a request is")
        .check(checkNetworkText)
        .unit("ADDRESS")
        .live();
    g.option("--agent-port", o.net.agent_port, "tells HAProxy's agent-check how much room there is; 0: none")
        .range(0, 65535);
    g.option("--web-root", o.net.web_root, "folder of the built page");
    g.several("--allow-origin", o.net.allowed_origins, ',',
              "pages of this origin may connect too, http://127.0.0.1:8000 for example; * for any")
        .check(checkOrigin)
        .unit("ORIGIN")
        .live();
    g.several("--host", o.net.hosts, ',', "without a key: a name that requests may have in their Host header")
        .check(checkHost)
        .unit("NAME")
        .live();
    g.option("--network-threads", o.net.threads, "threads that serve connections").range(1, 64);
}

} // namespace brume

#include "server/net/origin.h"

#include <algorithm>
#include <optional>

#include <arpa/inet.h>

namespace brume::net {
namespace {

bool sameText(std::string_view a, std::string_view b) { // host names and schemes: ASCII, any case
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

// "clouds:80" and "clouds" are one host over http, "clouds:443" and "clouds" over https.
std::string_view withoutPort(std::string_view host, std::string_view port) {
    return host.ends_with(port) ? host.substr(0, host.size() - port.size()) : host;
}

bool isAddress(int family, std::string_view text) {
    in6_addr address; // large enough for IPv4 and IPv6
    return inet_pton(family, std::string(text).c_str(), &address) == 1;
}

// True for "localhost" and for names below it, such as "brume.localhost".
bool isLocalhost(std::string_view name) {
    constexpr std::string_view kName = "localhost";
    if (name.size() < kName.size()) return false;
    const size_t above = name.size() - kName.size();
    return sameText(name.substr(above), kName) && (above == 0 || name[above - 1] == '.');
}

bool listed(std::string_view origin, const std::vector<std::string>& allowed) {
    return std::any_of(allowed.begin(), allowed.end(),
                       [&](const std::string& entry) { return entry == "*" || sameText(entry, origin); });
}

// The origin of a URL: "https://a.example" for "https://a.example/page?x".
std::string_view originOf(std::string_view url) {
    const size_t host = url.find("://");
    return host == url.npos ? std::string_view() : url.substr(0, url.find('/', host + 3));
}

// A host without its port: "clouds" for "clouds" and "clouds:8080". Nothing if no number follows the colon.
std::optional<std::string_view> nameOf(std::string_view host) {
    const size_t end = host.find(':', host.starts_with('[') ? std::min(host.find(']'), host.size()) : 0);
    if (end == host.npos) return host;
    const std::string_view port = host.substr(end + 1);
    const bool number = std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; });
    return number ? std::optional(host.substr(0, end)) : std::nullopt;
}

// True for a page that this very host served: "https://clouds:8080" with Host "clouds:8080".
bool isOwn(std::string_view origin, std::string_view host) {
    for (const auto& [scheme, port] :
         {std::pair<std::string_view, std::string_view>{"http://", ":80"}, {"https://", ":443"}})
        if (origin.size() > scheme.size() && sameText(origin.substr(0, scheme.size()), scheme))
            return !host.empty() && sameText(withoutPort(origin.substr(scheme.size()), port), withoutPort(host, port));
    return false;
}

} // namespace

bool hostAllowed(std::string_view host, const NetOptions& options) {
    const auto name = nameOf(host);
    if (!name || name->empty()) return false;
    if (isLocalhost(*name)) return true;
    if (name->starts_with('[')) return name->ends_with(']') && isAddress(AF_INET6, name->substr(1, name->size() - 2));
    if (isAddress(AF_INET, *name)) return true;
    if (sameText(*name, options.listen)) return true;
    return std::any_of(options.hosts.begin(), options.hosts.end(),
                       [&](const std::string& one) { return sameText(one, *name); });
}

const char* resourcePolicy(const NetOptions& options) {
    return options.allowed_origins.empty() ? "same-origin" : "cross-origin";
}

bool pageAllowed(const Asker& asker, const std::vector<std::string>& allowed) {
    const bool other = !asker.site.empty() && !sameText(asker.site, "same-origin") && !sameText(asker.site, "none");
    if (asker.origin.empty()) return !other || listed(originOf(asker.referer), allowed);
    return listed(asker.origin, allowed) || (!other && isOwn(asker.origin, asker.host));
}

std::optional<std::string> sharedWith(std::string_view origin, const std::vector<std::string>& allowed) {
    if (origin.empty() || !listed(origin, allowed)) return {};
    return std::string(origin);
}

} // namespace brume::net

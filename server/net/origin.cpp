#include "server/net/origin.h"

#include <algorithm>

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

} // namespace

bool originAllowed(std::string_view origin, std::string_view host, const std::vector<std::string>& allowed) {
    if (origin.empty()) return true;
    for (const std::string& entry : allowed)
        if (entry == "*" || sameText(entry, origin)) return true;
    for (const auto& [scheme, port] : {std::pair<std::string_view, std::string_view>{"http://", ":80"}, {"https://", ":443"}})
        if (origin.size() > scheme.size() && sameText(origin.substr(0, scheme.size()), scheme))
            return !host.empty() && sameText(withoutPort(origin.substr(scheme.size()), port), withoutPort(host, port));
    return false;
}

} // namespace brume::net

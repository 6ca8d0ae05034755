#include "server/cluster/trust.h"

#include <algorithm>
#include <cctype>

namespace brume::cluster {
namespace {

std::string small(std::string_view text) {
    std::string out(text);
    std::ranges::transform(out, out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return out;
}

// "USER:PASSWORD@HOST:PORT" of a URL.
std::string_view authorityOf(std::string_view url) {
    const size_t scheme = url.find("://");
    if (scheme == url.npos) return {};
    url.remove_prefix(scheme + 3);
    return url.substr(0, url.find_first_of("/?#"));
}

// True for names and addresses that lead to this machine alone.
bool isHere(const std::string& host) {
    return host == "localhost" || host.ends_with(".localhost") || host == "::1" ||
           (host.starts_with("127.") && host.find_first_not_of("0123456789.") == host.npos);
}

// True for a user with a password, and for a token.
bool hasSecret(std::string_view url) {
    const std::string_view authority = authorityOf(url);
    const size_t at = authority.rfind('@');
    if (at == authority.npos) return false;
    const std::string_view user = authority.substr(0, at);
    return !user.empty() && user.back() != ':';
}

} // namespace

std::vector<std::string> listOf(std::string_view list) {
    std::vector<std::string> all;
    for (size_t at = 0, end; at <= list.size(); at = end + 1) {
        end = std::min(list.find(',', at), list.size());
        if (end > at) all.emplace_back(list.substr(at, end - at));
    }
    return all;
}

std::string hostOf(std::string_view url) {
    std::string_view host = authorityOf(url);
    if (const size_t at = host.rfind('@'); at != host.npos) host.remove_prefix(at + 1);
    if (host.starts_with('[')) return small(host.substr(1, host.find(']') - 1));
    return small(host.substr(0, host.find(':')));
}

std::string openServer(const EngineOptions& options) {
    if (!options.credentials.empty() || !options.certificate.empty()) return {};
    for (const std::string& url : listOf(options.servers))
        if (const std::string host = hostOf(url); !isHere(host) && !hasSecret(url))
            return url.substr(0, url.find("://") + 3) + host;
    return {};
}

Hosts::Hosts(std::string_view listed, std::string_view own) : listed_(listOf(small(listed))), own_(hostOf(own)) {}

bool Hosts::allow(std::string_view url) const {
    // Browsers leave out control characters, and take a backslash for '/': they would read another host.
    const bool plain = std::ranges::all_of(url, [](char c) { return c > ' ' && c < 0x7f && c != '@' && c != '\\'; });
    const std::string host = hostOf(url);
    if (!plain || host.empty()) return false;
    if (host == own_ || (isHere(host) && isHere(own_))) return true;
    return std::ranges::any_of(listed_, [&](const std::string& one) {
        return one == host || (one.starts_with("*.") && host.ends_with(one.substr(1)));
    });
}

} // namespace brume::cluster

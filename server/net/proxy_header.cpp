#include "server/net/proxy_header.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include <arpa/inet.h>

namespace brume::net {
namespace {

using Bytes = std::span<const uint8_t>;
using Read = std::variant<ProxyMore, ProxySource, ProxyFault>;

constexpr std::string_view kText = "PROXY ", kBinary("\r\n\r\n\0\r\nQUIT\n", 12);
constexpr size_t kMostText = 107, kLeastText = sizeof "PROXY UNKNOWN\r\n" - 1; // bytes of version 1
constexpr size_t kFixed = 16;                                                  // bytes before the addresses, version 2

constexpr ProxyFault kBroken{"a PROXY protocol header that is broken: the gateway must send version 1 or 2"};
constexpr ProxyFault kTooLong{"a PROXY protocol header of more than 2048 bytes: let the gateway add fewer fields"};
constexpr ProxyFault kFamily{
    "a PROXY protocol header of a family that is not served: let the gateway pass on TCP over IPv4 or IPv6"};

bool begins(std::string_view text, std::string_view with) {
    const size_t common = std::min(text.size(), with.size());
    return text.substr(0, common) == with.substr(0, common);
}

std::string textOf(int family, const void* address) {
    std::array<char, INET6_ADDRSTRLEN> text{};
    return inet_ntop(family, address, text.data(), text.size()) ? text.data() : "";
}

// A port of version 1: decimal, without zeros before it.
bool isPort(std::string_view text) {
    if (text.empty() || text.size() > 5 || (text.size() > 1 && text[0] == '0')) return false;
    unsigned value = 0;
    for (const char c : text) {
        if (c < '0' || c > '9') return false;
        value = value * 10 + unsigned(c - '0');
    }
    return value <= 65535;
}

// The first word, which is taken out of `text` with the space behind it.
std::string_view takeWord(std::string_view& text) {
    const size_t end = text.find(' ');
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    return word;
}

// "PROXY TCP4 203.0.113.7 192.0.2.1 40000 8080\r\n"
Read readText(std::string_view begun) {
    if (begun.size() < kLeastText) return ProxyMore{kLeastText - begun.size()};
    const size_t end = begun.substr(0, kMostText).find('\n');
    if (end == begun.npos) {
        const size_t more = begun.back() == '\r' ? 1 : 2; // the end of the line at least
        if (begun.size() + more > kMostText) return kBroken;
        return ProxyMore{more};
    }
    if (begun[end - 1] != '\r') return kBroken;
    const ProxySource own{"", end + 1};
    std::string_view line = begun.substr(0, end - 1);
    if (line.find_first_of(std::string_view("\r\0", 2)) != line.npos) return kBroken;
    takeWord(line);
    const std::string_view family = takeWord(line);
    if (family == "UNKNOWN") return own;
    if (family != "TCP4" && family != "TCP6") return kFamily;
    const int version = family == "TCP4" ? AF_INET : AF_INET6;
    const std::string source(takeWord(line)), target(takeWord(line));
    in6_addr address, unused; // large enough for both
    if (inet_pton(version, source.c_str(), &address) != 1 || inet_pton(version, target.c_str(), &unused) != 1)
        return kBroken;
    const std::string_view from = takeWord(line);
    if (!isPort(from) || !isPort(line)) return kBroken;
    return ProxySource{textOf(version, &address), end + 1};
}

// Twelve bytes of signature; version and command; family and protocol; the number of bytes that follow. These are
// source address, target address, both ports, and additional fields.
Read readBinary(Bytes begun) {
    if (begun.size() < kFixed) return ProxyMore{kFixed - begun.size()};
    const unsigned version = begun[12] >> 4, command = begun[12] & 15u, family = begun[13];
    const size_t size = kFixed + (size_t{begun[14]} << 8 | begun[15]);
    if (version != 2 || command > 1) return kBroken;
    if (size > kMostProxyHeader) return kTooLong;
    constexpr unsigned kUnspecified = 0, kTcp4 = 0x11, kTcp6 = 0x21;
    const bool own = command == 0 || family == kUnspecified;
    if (!own && family != kTcp4 && family != kTcp6) return kFamily;
    const size_t addresses = family == kTcp4 ? 2 * 4 + 4 : 2 * 16 + 4;
    if (!own && size < kFixed + addresses) return kBroken;
    if (begun.size() < size) return ProxyMore{size - begun.size()};
    if (own) return ProxySource{"", size};
    return ProxySource{textOf(family == kTcp4 ? AF_INET : AF_INET6, &begun[kFixed]), size};
}

} // namespace

Read readProxyHeader(Bytes begun) {
    const std::string_view text(reinterpret_cast<const char*>(begun.data()), begun.size());
    if (begins(text, kBinary)) {
        if (text.size() < kBinary.size()) return ProxyMore{kBinary.size() - text.size()};
        return readBinary(begun);
    }
    if (begins(text, kText)) return readText(text);
    return ProxyFault{kNoProxyHeader};
}

} // namespace brume::net

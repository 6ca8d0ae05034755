// The PROXY protocol of HAProxy, versions 1 (text) and 2 (binary): a gateway says before everything else whose
// connection it passes on. https://www.haproxy.org/download/3.0/doc/proxy-protocol.txt
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>

namespace brume::net {

inline constexpr size_t kMostProxyHeader = 2048; // bytes, with the additional fields of version 2

// The header goes on. All of the next so many bytes belong to it.
struct ProxyMore {
    size_t bytes;
};
struct ProxySource {
    // In the usual text form, IPv4 or IPv6. Empty: the peer's own, since the gateway speaks for itself or does not
    // know.
    std::string address;
    size_t size; // bytes of the header
};
struct ProxyFault {
    const char* line; // says what to do
};

inline constexpr char kNoProxyHeader[] =
    "no PROXY protocol header: connect through the gateway, or start without --proxy-protocol";

// Reads the first bytes of a connection. Who reads as many bytes as ProxyMore says, again and again, reads exactly the
// header and nothing behind it.
std::variant<ProxyMore, ProxySource, ProxyFault> readProxyHeader(std::span<const uint8_t> begun);

} // namespace brume::net

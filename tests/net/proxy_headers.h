// Headers of the PROXY protocol, as a gateway sends them.
#pragma once

#include <array>
#include <stdexcept>
#include <string>

#include <arpa/inet.h>

namespace brume::test {

// Of version 2, with these bytes after the fixed part. `command`: 0 LOCAL, 1 PROXY; `family`: 0x11 TCP over IPv4.
inline std::string binaryHeader(unsigned command, unsigned family, const std::string& rest) {
    std::string header("\r\n\r\n\0\r\nQUIT\n", 12);
    for (const unsigned byte : {0x20 | command, family, unsigned(rest.size() >> 8), unsigned(rest.size() & 255)})
        header += char(byte);
    return header + rest;
}

// Source, target and ports of TCP over IPv4 or IPv6. The target is the same address.
inline std::string addressesOf(const std::string& source) {
    std::array<char, 16> address{};
    const bool v6 = source.find(':') != std::string::npos;
    if (inet_pton(v6 ? AF_INET6 : AF_INET, source.c_str(), address.data()) != 1)
        throw std::invalid_argument("no address: " + source);
    const std::string one(address.data(), v6 ? 16 : 4);
    return one + one + std::string("\x9c\x40\x1f\x90", 4);
}

// A connection from this address.
inline std::string headerOf(const std::string& source, const std::string& fields = {}) {
    return binaryHeader(1, source.find(':') == std::string::npos ? 0x11 : 0x21, addressesOf(source) + fields);
}

} // namespace brume::test

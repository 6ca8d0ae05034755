// Addresses of this machine.
#pragma once

#include <string>

#include <arpa/inet.h>

namespace brume {

// True for 127.0.0.0/8, ::1 and the name localhost. Other machines cannot reach these.
inline bool isLoopback(const std::string& host) {
    in_addr v4{};
    in6_addr v6{};
    if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24 == 127;
    if (inet_pton(AF_INET6, host.c_str(), &v6) == 1) return IN6_IS_ADDR_LOOPBACK(&v6) != 0;
    return host == "localhost";
}

} // namespace brume

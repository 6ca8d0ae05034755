// What the kernel knows of a TCP connection.
#pragma once

#include <chrono>
#include <cstddef>

namespace brume::net {

struct TcpState {
    // Smoothed round trip over the least one: how long segments wait on the way, whatever the program at the other end does.
    // Without end where the kernel does not say, so that only other measurements count.
    std::chrono::duration<float, std::milli> queue = std::chrono::duration<float, std::milli>::max();
    bool backlog = true; // bytes wait here for the link to take them
};

// Of a connected socket.
TcpState tcpState(int socket);

} // namespace brume::net

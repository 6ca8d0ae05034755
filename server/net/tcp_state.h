// What the kernel knows of a TCP connection.
#pragma once

#include <chrono>
#include <cstddef>

namespace brume::net {

struct TcpState {
    // The smoothed round trip minus the least one: how long segments wait on the way, independent of the program at the
    // other end. Infinite if the kernel does not say, so that only other measurements count.
    std::chrono::duration<float, std::milli> queue = std::chrono::duration<float, std::milli>::max();
    bool backlog = true; // true: bytes wait in the kernel for the link
};

// The state of a connected socket.
TcpState tcpState(int socket);

// True: the peer has closed or reset the connection. Bytes that it sent before may still be unread.
bool peerHasGone(int socket);

} // namespace brume::net

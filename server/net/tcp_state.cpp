#include "server/net/tcp_state.h"

#include <algorithm>
#include <cstddef>

#include <linux/tcp.h> // has newer fields than netinet/tcp.h; both cannot be included
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

namespace brume::net {

TcpState tcpState(int socket) {
    tcp_info info{};
    socklen_t size = sizeof info;
    constexpr size_t kNeeded = offsetof(tcp_info, tcpi_min_rtt) + sizeof info.tcpi_min_rtt; // the last field read
    static_assert(offsetof(tcp_info, tcpi_notsent_bytes) < kNeeded && offsetof(tcp_info, tcpi_rtt) < kNeeded);
    if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || size < kNeeded) return {};
    const uint32_t us = info.tcpi_rtt - std::min(info.tcpi_rtt, info.tcpi_min_rtt);
    return {std::chrono::duration<float, std::micro>(us), info.tcpi_notsent_bytes > 0};
}

bool peerHasGone(int socket) {
    pollfd look{socket, POLLRDHUP, 0};
    return ::poll(&look, 1, 0) > 0; // also for POLLHUP and POLLERR, which are always looked for
}

} // namespace brume::net

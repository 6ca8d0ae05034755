#include "server/net/proxy_header.h"

#include <arpa/inet.h>

#include "tests/fuzz/promise.h"

namespace brume::fuzz {

// Read as a connection is: as many bytes as the header asks for, no more.
void proxy(Bytes input) {
    size_t taken = 0;
    for (;;) {
        const auto read = net::readProxyHeader(input.first(taken));
        if (const auto* more = std::get_if<net::ProxyMore>(&read)) {
            promise(more->bytes > 0, "a header goes on or ends");
            promise(taken + more->bytes <= net::kMostProxyHeader, "a header is short");
            if (input.size() - taken < more->bytes) return;
            taken += more->bytes;
            continue;
        }
        if (const auto* fault = std::get_if<net::ProxyFault>(&read)) return promiseOneLine(fault->line, 128);
        const auto& source = std::get<net::ProxySource>(read);
        promise(source.size == taken, "exactly the header is read");
        in6_addr address;
        const bool known = inet_pton(AF_INET, source.address.c_str(), &address) == 1 ||
                           inet_pton(AF_INET6, source.address.c_str(), &address) == 1;
        promise(known || source.address.empty(), "an address, or the peer's own", source.address);
        const auto whole = net::readProxyHeader(input);
        const auto* same = std::get_if<net::ProxySource>(&whole);
        promise(same && same->size == taken && same->address == source.address, "what follows changes nothing");
        return;
    }
}

} // namespace brume::fuzz

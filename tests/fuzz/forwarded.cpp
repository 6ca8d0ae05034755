#include <algorithm>
#include <string>
#include <vector>

#include "server/net/address.h"
#include "tests/fuzz/promise.h"

namespace brume::fuzz {

// The input is lines of X-Forwarded-For.
void forwarded(Bytes input) {
    const std::string_view text(reinterpret_cast<const char*>(input.data()), input.size());
    std::vector<std::string_view> lines;
    for (size_t begin = 0; begin <= text.size();) {
        const size_t end = std::min(text.find('\n', begin), text.size());
        lines.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    const net::Address proxy = *net::Address::read("10.0.0.1"), stranger = *net::Address::read("203.0.113.9");
    const std::vector<net::Network> trusted{*net::Network::read("10.0.0.0/8"), *net::Network::read("2001:db8::/32")};
    promise(net::forwardedFor(stranger, lines, trusted) == stranger, "who is not trusted is not believed");
    const net::Address whose = net::forwardedFor(proxy, lines, trusted);
    promise(net::Address::read(whose.text()) == whose, "an address, which reads as it is told", whose.text());
    promise(!whose.network().empty(), "it has a network");
    // Whatever a visitor writes comes before what the proxy appends.
    std::vector<std::string_view> appended = lines;
    const std::string last = std::string(appended.back()) + ", 203.0.113.9";
    appended.back() = last;
    promise(net::forwardedFor(proxy, appended, trusted) == stranger, "nothing before the proxy's entry counts");
    if (const auto network = net::Network::read(text))
        promise(network->holds(*net::Address::read(text.substr(0, text.find('/')))), "a network holds its first");
}

} // namespace brume::fuzz

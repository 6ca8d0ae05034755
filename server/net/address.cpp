#include "server/net/address.h"

#include <algorithm>
#include <charconv>

#include <arpa/inet.h>

namespace brume::net {
namespace {

constexpr size_t kLongestAddress = 45; // INET6_ADDRSTRLEN without its end
constexpr std::array<uint8_t, 12> kMapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

std::string textOf(int family, const uint8_t* bytes) {
    std::array<char, INET6_ADDRSTRLEN> text{};
    return inet_ntop(family, bytes, text.data(), text.size());
}

bool isDigits(std::string_view text) {
    return !text.empty() && text.size() <= 5 && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

// An entry of the header: an address, some proxies append a port: "192.0.2.7:40000", "[2001:db8::7]:40000".
std::optional<Address> readEntry(std::string_view entry) {
    if (entry.starts_with('[')) {
        const size_t end = entry.find(']');
        if (end == entry.npos) return {};
        const std::string_view after = entry.substr(end + 1);
        if (!after.empty() && !(after.front() == ':' && isDigits(after.substr(1)))) return {};
        return Address::read(entry.substr(1, end - 1));
    }
    const size_t colon = entry.find(':');
    const bool one = colon != entry.npos && entry.find(':', colon + 1) == entry.npos;
    if (one && !isDigits(entry.substr(colon + 1))) return {};
    return Address::read(one ? entry.substr(0, colon) : entry);
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kSpace = " \t";
    const size_t begin = std::min(text.find_first_not_of(kSpace), text.size());
    return text.substr(begin, text.find_last_not_of(kSpace) + 1 - begin); // npos + 1 is 0, and begin is size() then
}

} // namespace

std::optional<Address> Address::read(std::string_view text) {
    if (text.size() > kLongestAddress || text.find('\0') != text.npos) return {};
    const std::string ended(text);
    Address address;
    if (inet_pton(AF_INET6, ended.c_str(), address.bytes_.data()) == 1) return address;
    std::ranges::copy(kMapped, address.bytes_.begin());
    if (inet_pton(AF_INET, ended.c_str(), address.bytes_.data() + kMapped.size()) == 1) return address;
    return {};
}

bool Address::isV4() const { return std::equal(kMapped.begin(), kMapped.end(), bytes_.begin()); }

std::string Address::text() const {
    return isV4() ? textOf(AF_INET, bytes_.data() + kMapped.size()) : textOf(AF_INET6, bytes_.data());
}

std::string Address::network() const {
    if (isV4()) return text();
    Address first = *this;
    std::fill(first.bytes_.begin() + 8, first.bytes_.end(), uint8_t{0});
    return first.text() + "/64";
}

std::optional<Network> Network::read(std::string_view text) {
    const size_t slash = text.find('/');
    const auto address = Address::read(text.substr(0, slash));
    if (!address) return {};
    const unsigned most = address->isV4() ? 32 : 128;
    unsigned bits = most;
    if (slash != text.npos) {
        const std::string_view number = text.substr(slash + 1);
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), bits);
        if (error != std::errc{} || end != number.data() + number.size() || bits > most) return {};
    }
    Network network;
    network.first_ = *address;
    network.bits_ = bits + (128 - most);
    for (unsigned bit = network.bits_; bit < 128; ++bit)
        if (address->bytes_[bit / 8] >> (7 - bit % 8) & 1) return {};
    return network;
}

bool Network::holds(const Address& address) const {
    for (unsigned bit = 0; bit < bits_; bit += 8) {
        const unsigned left = std::min(bits_ - bit, 8u);
        if ((first_.bytes_[bit / 8] ^ address.bytes_[bit / 8]) >> (8 - left)) return false;
    }
    return true;
}

bool isTrusted(const Address& address, std::span<const Network> trusted) {
    return std::ranges::any_of(trusted, [&](const Network& one) { return one.holds(address); });
}

Address forwardedFor(const Address& peer, std::span<const std::string_view> lines, std::span<const Network> trusted) {
    Address whose = peer;
    for (size_t line = lines.size(); line-- > 0;) {
        std::string_view rest = lines[line];
        for (bool more = true; more;) {
            if (!isTrusted(whose, trusted)) return whose;
            const size_t comma = rest.rfind(',');
            more = comma != rest.npos;
            const auto entry = readEntry(trimmed(more ? rest.substr(comma + 1) : rest));
            if (!entry) return whose;
            whose = *entry;
            rest = rest.substr(0, more ? comma : 0);
        }
    }
    return whose;
}

} // namespace brume::net

// Addresses of peers: how they are told, what counts as one, and networks of them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace brume::net {

// Of IPv6; one of IPv4 is mapped to it (::ffff:192.0.2.7), as a listener of :: sees it.
class Address {
public:
    // Reads "192.0.2.7" or "2001:db8::7", without port or scope. Nothing for any other text.
    static std::optional<Address> read(std::string_view text);
    bool isV4() const;
    std::string text() const; // "192.0.2.7" for one of IPv4
    // The network that limits count as one address, as text: an IPv4 address; of IPv6 the first 64 bits, which belong
    // to one site.
    std::string network() const;
    bool operator==(const Address&) const = default;

private:
    friend class Network;
    std::array<uint8_t, 16> bytes_{};
};

// Addresses whose first bits are the same.
class Network {
public:
    // Reads "192.0.2.7", "192.0.2.0/24", "::1" or "2001:db8::/32". Nothing for any other text, and where bits beyond
    // the given ones are set.
    static std::optional<Network> read(std::string_view text);
    bool holds(const Address& address) const;

private:
    Address first_;
    unsigned bits_ = 0; // of IPv6
};

bool isTrusted(const Address& address, std::span<const Network> trusted);

// Whose request it is that comes from `peer`, by the lines of its header X-Forwarded-For, in their order. Each proxy
// appends whom it heard: an entry counts only where the one who wrote it is trusted. So this is the last entry that is
// not a trusted proxy's; where all are, the first. `peer` itself if it is not trusted, or said nothing that is an
// address; where an entry is none, the proxy that wrote it.
Address forwardedFor(const Address& peer, std::span<const std::string_view> lines, std::span<const Network> trusted);

} // namespace brume::net

// Bytes that gzip has packed (RFC 1952).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace brume {

// Unpacks them to `size` bytes, and never to more. Returns what is wrong, in one line; empty: nothing. Memory grows
// with what comes out, not with what is expected.
std::string unpackGzip(std::string_view packed, uint64_t size, std::string& out);

} // namespace brume

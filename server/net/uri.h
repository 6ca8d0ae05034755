// The little of RFC 3986 that a request needs.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace brume::net {

// Empty if a % is not followed by two hexadecimal digits.
std::optional<std::string> percentDecode(std::string_view text);

// "w=640&h=360" as decoded names and values. Empty if the encoding is broken or a name comes twice.
std::optional<std::map<std::string, std::string, std::less<>>> parseQuery(std::string_view query);

} // namespace brume::net

// Who may do what: small signed tokens, made by whoever holds the key.
//
//   base64url({"exp":1767225600,"name":"ann","role":"viewer"}) "." base64url(HMAC-SHA256(key, all that is before the dot))
//
// base64url of RFC 4648, without padding. `exp`: seconds since 1970, UTC; `name`, for the log, may be missing.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "protocol/brume_generated.h"

namespace brume::net {

using wire::Role;
using Seconds = std::chrono::sys_seconds;

inline constexpr size_t kMostTokenBytes = 512, kMostTokenName = 64;
inline constexpr size_t kLeastKeyBytes = 32, kMostKeyBytes = 4096; // no shorter than what HMAC-SHA256 gives
inline constexpr std::chrono::seconds kLongestToken = std::chrono::hours(24);
inline constexpr std::chrono::seconds kClockSkew{30}; // that the clocks of who makes tokens and who reads them may be apart

struct Claims {
    Role role = Role::viewer;
    Seconds expires;  // kClockSkew later it is no good any more
    std::string name; // printable ASCII
};

// Why a token is none, as one line.
using TokenFault = const char*;

// What the part before the dot says, whoever signed it: exactly the fields above, each within its limits but for the time.
std::optional<Claims> readClaims(std::string_view payload);

// The claims of a token that was made with this key and is good now. In this order: length, signature, content, time. Any text
// is answered, in a time that does not depend on how much of the signature is right.
std::variant<Claims, TokenFault> readToken(std::string_view token, std::string_view key, Seconds now);

// Precondition: the name is of at most kMostTokenName printable ASCII characters.
std::string makeToken(const Claims& claims, std::string_view key);

// "viewer", "controller", "operator".
const char* nameOf(Role role);
std::optional<Role> roleNamed(std::string_view name);

} // namespace brume::net

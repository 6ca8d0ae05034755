// Signed tokens, which say what role their holder has. Anyone with the key can make them.
//
//   base64url({"exp":1767225600,"name":"ann","role":"viewer"}) "." base64url(HMAC-SHA256(key, all that is before the
//   dot))
//
// base64url of RFC 4648, without padding. `exp`: seconds since 1970, UTC. `name`, for the log, may be missing, and
// `room`, whose token is good in that room alone (rooms.h).
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
inline constexpr std::chrono::seconds kClockSkew{30}; // allowed difference between the clocks of maker and reader

struct Claims {
    Role role = Role::viewer;
    Seconds expires;    // the token is refused from kClockSkew after this
    std::string name{}; // printable ASCII, for the log
    std::string room{}; // the one that it is good for; empty: all, and the server
};

// Why a token is refused: one line.
using TokenFault = const char*;

// The claims in the part before the dot, without checking signature or time. Empty if a field is missing, unknown or
// out of its limits.
std::optional<Claims> readClaims(std::string_view payload);

// The claims of a token that was made with this key and is good now. Checks length, signature, content and time, in
// this order. Any text may be given. The time it takes does not depend on how much of the signature is right.
std::variant<Claims, TokenFault> readToken(std::string_view token, std::string_view key, Seconds now);

// Precondition: the name has at most kMostTokenName printable ASCII characters; the room is empty or isRoomName().
std::string makeToken(const Claims& claims, std::string_view key);

// "viewer", "pusher", "controller", "presenter", "operator".
const char* nameOf(Role role);
// True: `role` may do all that `least` may.
bool atLeast(Role role, Role least);
std::optional<Role> roleNamed(std::string_view name);

} // namespace brume::net

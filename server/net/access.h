// Who sends a request, and what that lets it do.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "server/net/options.h"
#include "server/net/reply.h"
#include "server/net/token.h"
#include "server/viewer/frame.h"

namespace brume::net {

struct Authorization {
    Role role = Role::operator_;            // the role of everyone if the server has no token key
    std::optional<Clock::time_point> until; // when the token ends, and the session with it; empty without a token key
    std::string name;                       // of the token, for the log; may be empty
};

// Newcomer::owner of who comes with it. `network`: ConnectionSlot::network().
inline std::string ownerOf(const Authorization& authorization, const std::string& network) {
    return authorization.name.empty() ? "address " + network : "token " + authorization.name;
}

// Reads the token in the header `Authorization: Bearer ...` or, without one, the `token` of the query. Without a token
// key everyone is operator. A refusal is HTTP 401 and one line if there is no good token, 403 if its role is below
// `least` or it is good for another room alone. `room`: that is asked for; empty: the one at "/", or the server.
std::variant<Authorization, Reply> authorize(std::string_view header, std::string_view query, Role least,
                                             const NetOptions& options, std::string_view room = {});

// "role viewer may not do that: it takes controller"
std::string forbidden(Role role, Role least);

} // namespace brume::net

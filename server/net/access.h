// Who a request comes from, and what that lets it do.
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

struct Clearance {
    Role role = Role::operator_;            // of everyone where there is no key
    std::optional<Clock::time_point> until; // the session's end
    std::string name;                       // for the log
};

// By the token in the header `Authorization: Bearer ...`, or else in the query's `token`; without a key everyone is operator. A
// refusal is 401 and one line where there is no good token, 403 where its role is below `least`.
std::variant<Clearance, Reply> clear(std::string_view authorization, std::string_view query, Role least,
                                     const NetOptions& options);

// "a viewer may not do that: it takes the role controller"
std::string forbidden(Role role, Role least);

} // namespace brume::net

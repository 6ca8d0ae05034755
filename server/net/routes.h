// Routes: the paths that the server answers itself, and what each takes. All other paths are files of the page.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "server/net/token.h"

namespace brume::net {

struct Route {
    std::string_view path;
    std::string_view methods;  // as in the header Allow: "GET, HEAD", "GET" or "POST"
    std::optional<Role> least; // the least role that it takes; nothing: everybody may ask
    bool takes_file = false;   // True: a request's body may be as long as NetOptions::max_upload
    bool of_server = false;    // True: it is not below "/r/NAME" (rooms.h), as all others are, too

    bool takes(std::string_view method) const;
};

std::span<const Route> allRoutes();
// Null for a path of the page. In a room the same as at "/".
const Route* routeOf(std::string_view path);

} // namespace brume::net

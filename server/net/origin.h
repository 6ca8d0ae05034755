// Which pages may open our WebSocket. A browser tells the page's origin; other programs tell none.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace brume::net {

// True without an origin, for a page that this very host served ("https://clouds:8080" with Host "clouds:8080"), for an origin in
// `allowed` and for every one when that holds "*".
bool originAllowed(std::string_view origin, std::string_view host, const std::vector<std::string>& allowed);

} // namespace brume::net

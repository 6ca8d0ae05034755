// What a browser's request says of itself: the host it means to ask, and the page that asks.
//
// Without a token key everyone who reaches the server is operator, so a web page must not reach it through its
// visitor's browser. A page whose name is made to lead to this machine (DNS rebinding) shows by its Host header; a page
// that embeds its pictures shows by Sec-Fetch-Site; a page that opens the WebSocket shows by its Origin. Other programs
// send none of these but Host.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/net/options.h"

namespace brume::net {

// True if the Host header `host`, with or without a port, is "localhost", a name below it, an IP address (of version 6
// in brackets), one of options.hosts, or options.listen. Upper and lower case are the same.
bool hostAllowed(std::string_view host, const NetOptions& options);

// True if a page of `origin` may open the WebSocket: without an origin, for a page that this very host served
// ("https://clouds:8080" with Host "clouds:8080"), for an origin in `allowed`, and for every origin if `allowed` holds
// "*".
bool originAllowed(std::string_view origin, std::string_view host, const std::vector<std::string>& allowed);

// False if the browser says that a page of another site makes this request (`site`, the header Sec-Fetch-Site, is
// "cross-site"), unless that page's origin is in `allowed` or `allowed` holds "*". The page's origin is `origin` or,
// without one, that of `referer`. Browsers send Sec-Fetch-Site over https and to loopback addresses only.
bool siteAllowed(std::string_view site, std::string_view origin, std::string_view referer,
                 const std::vector<std::string>& allowed);

// The header Cross-Origin-Resource-Policy of every reply: whose pages a browser lets embed it.
const char* resourcePolicy(const NetOptions& options);

} // namespace brume::net

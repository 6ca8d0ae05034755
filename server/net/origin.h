// What a browser's request says of itself: the host it means to ask, and the page that asks.
//
// Without a token key everyone who reaches the server is operator, so a web page must not reach it through its
// visitor's browser. A page whose name is made to lead to this machine (DNS rebinding) shows by its Host header; a page
// that embeds pictures shows by Sec-Fetch-Site; a page that opens the WebSocket or posts shows by its Origin. Other
// programs send none of these but Host.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/options.h"

namespace brume::net {

// True if the Host header `host`, with or without a port, is "localhost", a name below it, an IP address (of version 6
// in brackets), one of options.hosts, or options.listen. Upper and lower case are the same.
bool hostAllowed(std::string_view host, const NetOptions& options);

// What a browser says of the page that makes a request: values of its headers, empty where there is none.
struct Asker {
    std::string_view host;    // the host that the page asks
    std::string_view origin;  // the page's own: "https://clouds.example"; "null" for one that hides it
    std::string_view referer; // the page's address
    std::string_view site;    // Sec-Fetch-Site. Browsers send it over https and to loopback addresses only
};

// True if that page may see or change anything here. The page's origin is Asker::origin or, without one, that of its
// address. True for an origin in `allowed`, and for every origin if `allowed` holds "*". Of other pages: for those that
// this very host served ("https://clouds:8080" with Host "clouds:8080"). Without an origin: unless the browser says
// that the page is of another one, be it another port. Other programs than browsers send none of these.
bool pageAllowed(const Asker& asker, const std::vector<std::string>& allowed);

// The header Access-Control-Allow-Origin of a reply to a page of `origin`; nothing unless it is in `allowed`.
std::optional<std::string> sharedWith(std::string_view origin, const std::vector<std::string>& allowed);

// The header Cross-Origin-Resource-Policy of every reply: whose pages a browser lets embed it.
const char* resourcePolicy(const NetOptions& options);

} // namespace brume::net

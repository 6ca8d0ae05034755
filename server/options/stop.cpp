#include <algorithm>

#include "server/options/groups.h"

namespace brume {
// Viewers are told this URL: it holds no user or password, and a header or a log line can carry it.
std::string checkViewerUrl(const std::string& url) {
    const bool scheme = url.starts_with("http://") || url.starts_with("https://") || url.starts_with("ws://") ||
                        url.starts_with("wss://");
    const bool plain = std::all_of(url.begin(), url.end(), [](char c) { return c > ' ' && c < 0x7f && c != '@'; });
    if (url.empty() || (scheme && plain && url.size() <= 1024)) return {};
    return "allowed: a URL of http, https, ws or wss, without user and password, of 1024 characters at most";
}

void addStopOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Stop");
    g.milliseconds("--drain-time", o.drain, "told to stop: /readyz fails for so long while all else goes on", 0).live();
    g.option("--drain-to", o.drain_to, "URL that viewers are told to go on to")
        .unit("URL")
        .check(checkViewerUrl)
        .live();
    g.milliseconds("--grace", o.grace, "to end what is open after that").live();
}

} // namespace brume

// What every connection of one server shares.
#pragma once

#include <atomic>

#include "server/net/connections.h"
#include "server/net/metrics.h"
#include "server/net/options.h"
#include "server/net/pages.h"
#include "server/viewer/audience.h"

namespace brume::net {

struct Context {
    const NetOptions options;
    Audience& audience;
    Metrics& metrics;
    Pages pages{options.web_root};
    Connections connections{options.max_connections, options.max_connections_per_address};
    std::atomic<bool> stopping{false};
    std::atomic<uint32_t> streams{0}, snapshots{0}; // open now
};

} // namespace brume::net

// What every connection of one server shares.
#pragma once

#include <atomic>
#include <memory>

#include "server/net/connections.h"
#include "server/net/metrics.h"
#include "server/net/options.h"
#include "server/net/pages.h"
#include "server/viewer/audience.h"

namespace brume::net {

class Tls;

// One for the server.
struct House {
    Audience& audience;
    Metrics& metrics;
    Pages pages;
    Connections connections;
    std::atomic<bool> draining{false}; // /readyz fails, all else goes on
    std::atomic<bool> stopping{false};
    std::string go_to;                              // where viewers are sent; written before `stopping`, read after
    std::atomic<uint32_t> streams{0}, snapshots{0}; // open now
};

// One for every set of options that the server has had: a connection keeps those that held when it was accepted.
struct Context {
    Context(NetOptions with, std::shared_ptr<Tls> certificate, House& house)
        : options(std::move(with)), tls(std::move(certificate)), audience(house.audience), metrics(house.metrics),
          pages(house.pages), connections(house.connections), go_to(house.go_to), draining(house.draining),
          stopping(house.stopping), streams(house.streams), snapshots(house.snapshots) {}

    const NetOptions options;
    const std::shared_ptr<Tls> tls; // null: without
    Audience& audience;
    Metrics& metrics;
    Pages& pages;
    Connections& connections;
    const std::string& go_to;
    const std::atomic<bool>&draining, &stopping;
    std::atomic<uint32_t>&streams, &snapshots;
};

} // namespace brume::net

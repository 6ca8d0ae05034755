// What every connection of one server shares.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "server/net/connections.h"
#include "server/net/options.h"
#include "server/net/pages.h"
#include "server/net/places.h"
#include "server/net/rooms.h"
#include "server/net/visitor_log.h"

namespace brume::net {

class Tls;

// Adds one to a counter for as long as it lives.
class Counted {
public:
    explicit Counted(std::atomic<uint32_t>& count) : count_(count), number_(++count) {}
    ~Counted() { --count_; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    uint32_t number() const { return number_; } // the count with this one

private:
    std::atomic<uint32_t>& count_;
    const uint32_t number_;
};

// One for the server.
struct ServerState {
    Rooms rooms;
    Metrics& metrics; // of the network, which rooms share
    Pages pages;
    Connections connections;
    std::atomic<bool> draining{false}; // true: /readyz fails, all else goes on
    std::atomic<bool> stopping{false}; // true: connections end, and new ones are not served
    std::string go_to;                 // the URL that viewers are sent to; written before `stopping`, read after
    Places streams{"streams are open"}, snapshots{"snapshots are being drawn"}, uploads{"clouds are being uploaded"};
    VisitorLog log;
    std::atomic<uint32_t> contexts{0}; // alive now
};

// One for every set of options that the server has had. A connection keeps the one with which it was accepted, so a
// context lives as long as it is the newest or has a connection.
struct Context {
    Context(NetOptions with, std::shared_ptr<Tls> certificate, ServerState& server)
        : options(std::move(with)), tls(std::move(certificate)), rooms(server.rooms), metrics(server.metrics),
          pages(server.pages), connections(server.connections), go_to(server.go_to), draining(server.draining),
          stopping(server.stopping), streams(server.streams), snapshots(server.snapshots), uploads(server.uploads),
          log(server.log), counted(server.contexts) {}

    const NetOptions options;
    const std::shared_ptr<Tls> tls; // null: no TLS
    Rooms& rooms;
    Metrics& metrics;
    const Pages& pages;
    Connections& connections;
    const std::string& go_to;
    const std::atomic<bool>&draining, &stopping;
    Places &streams, &snapshots, &uploads;
    VisitorLog& log;
    const Counted counted;
};

} // namespace brume::net

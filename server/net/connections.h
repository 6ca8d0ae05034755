// Every open connection: how many there may be, and how to end them all.
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "server/net/rate.h"

namespace brume::net {

class Connection {
public:
    virtual ~Connection() = default;
    // Both from any thread; they return at once.
    virtual void stop() = 0; // end politely
    virtual void kill() = 0; // end now
};

class Connections {
public:
    struct Limits {
        uint32_t total, per_address;
        double accept_rate = 1e9, burst_s = 1; // of one address: connections a second, and for so long more at once
    };
    explicit Connections(const Limits& limits) : limits_(limits) {}

    // The right to one open connection, given back when it dies.
    class Place {
    public:
        ~Place();
        Place(const Place&) = delete;
        Place& operator=(const Place&) = delete;
        const std::string& address() const { return address_; }
        // Who sits here now. Stopped at once when everyone else already is.
        void occupy(const std::shared_ptr<Connection>& connection);

    private:
        friend Connections;
        Place(Connections& owner, std::string address, std::string network)
            : owner_(owner), address_(std::move(address)), network_(std::move(network)) {}
        Connections& owner_;
        const std::string address_, network_;
        std::weak_ptr<Connection> occupant_; // guarded by owner_.mutex_
    };

    // Null when there is no room, for all or for this address, or when it comes too often. `network` is
    // what counts as one address: of IPv6 the first 64 bits, which one site has to itself. Places must not outlive this object.
    enum class Refused { nothing, room, rate };
    std::unique_ptr<Place> take(const std::string& address, const std::string& network, Refused* why = nullptr);

    // For those to come: what is open stays.
    void setLimits(const Limits& limits);

    void stopAll();
    void killAll();
    // True when none is left before the deadline.
    bool waitUntilEmpty(std::chrono::steady_clock::time_point deadline);

private:
    std::vector<std::shared_ptr<Connection>> occupants();

    std::mutex mutex_;
    bool comesTooOften(const std::string& network); // with mutex_

    Limits limits_;
    std::condition_variable emptied_;
    std::set<Place*> places_;
    std::map<std::string, uint32_t> per_address_;
    std::map<std::string, TokenBucket> accepted_; // of addresses that came lately, kMostLately at most
    bool stopped_ = false;
};

} // namespace brume::net

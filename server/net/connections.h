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
    Connections(uint32_t max_total, uint32_t max_per_address) : max_total_(max_total), max_per_address_(max_per_address) {}

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
        Place(Connections& owner, std::string address) : owner_(owner), address_(std::move(address)) {}
        Connections& owner_;
        const std::string address_;
        std::weak_ptr<Connection> occupant_; // guarded by owner_.mutex_
    };

    // Null when there is no room, for all or for this address. Places must not outlive this object.
    std::unique_ptr<Place> take(const std::string& address);

    // For those to come: what is open stays.
    void setLimits(uint32_t max_total, uint32_t max_per_address);

    void stopAll();
    void killAll();
    // True when none is left before the deadline.
    bool waitUntilEmpty(std::chrono::steady_clock::time_point deadline);

private:
    std::vector<std::shared_ptr<Connection>> occupants();

    std::mutex mutex_;
    uint32_t max_total_, max_per_address_;
    std::condition_variable emptied_;
    std::set<Place*> places_;
    std::map<std::string, uint32_t> per_address_;
    bool stopped_ = false;
};

} // namespace brume::net

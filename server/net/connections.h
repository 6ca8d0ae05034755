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
    // Both may be called from any thread and return at once.
    virtual void stop() = 0; // ends the connection after what is being said
    virtual void kill() = 0; // ends the connection now
};

class ConnectionSlot;

// Thread-safe.
class Connections {
public:
    struct Limits {
        uint32_t total, per_address; // open connections
        double accept_rate = 1e9;    // new connections a second, of one address
        double burst_s = 1;          // a burst may be so many seconds of them
        // Open connections beyond those, for who comes when they are taken.
        uint32_t reserve = 0, reserve_per_address = 0;
    };
    explicit Connections(const Limits& limits) : limits_(limits) {}

    // The right to one open connection. Null if all slots are taken, or all of this address, also those of the reserve,
    // or if the address comes too often; `why` says which. `network` is what counts as one address: of IPv6 the first
    // 64 bits, which one site has to itself. Slots must not outlive this object.
    enum class Refused { nothing, full, rate };
    std::unique_ptr<ConnectionSlot> take(const std::string& address, const std::string& network,
                                         Refused* why = nullptr);
    // The right to one open connection of a proxy, which carries requests of others: the limits of one address do not
    // count it until ConnectionSlot::passTo() says whose it is. Null if all slots are taken.
    std::unique_ptr<ConnectionSlot> takeForOthers(const std::string& address, const std::string& network);
    // The right to one open connection that owes its PROXY protocol header: whose it is, that header says. Null if as
    // many owe theirs as may be open. Such slots are apart: the limits of take() do not count them.
    std::unique_ptr<ConnectionSlot> takeOwing(const std::string& address, const std::string& network);

    // New limits for later connections. Open ones stay.
    void setLimits(const Limits& limits);

    // From now on every connection is stopped, those that come later at once.
    void stopAll();
    void killAll();
    // True if no slot is taken before the deadline.
    bool waitUntilEmpty(std::chrono::steady_clock::time_point deadline);

private:
    friend ConnectionSlot;
    std::vector<std::shared_ptr<Connection>> open();
    std::unique_ptr<ConnectionSlot> add(std::unique_ptr<ConnectionSlot> slot); // with mutex_
    bool comesTooOften(const std::string& network);                            // with mutex_
    void count(ConnectionSlot& slot);                                          // with mutex_
    void discount(ConnectionSlot& slot);                                       // with mutex_

    std::mutex mutex_;
    Limits limits_;
    std::condition_variable emptied_;
    std::set<ConnectionSlot*> slots_;
    struct Share {
        uint32_t open = 0, reserved = 0;
    };
    std::map<std::string, Share> per_address_;
    uint32_t open_ = 0, reserved_ = 0, owing_ = 0; // slots that are taken, of each kind
    std::map<std::string, TokenBucket> accepted_;  // of the addresses that came lately, kMostLately at most
    bool stopped_ = false;
};

// Given back when it dies.
class ConnectionSlot {
public:
    ~ConnectionSlot();
    ConnectionSlot(const ConnectionSlot&) = delete;
    ConnectionSlot& operator=(const ConnectionSlot&) = delete;
    const std::string& address() const { return address_; }
    const std::string& network() const { return network_; } // what counts as one address
    // True: one of the reserve.
    bool reserved() const { return kind_ == Kind::reserved; }
    // For a slot of Connections::takeForOthers(), on the strand of its connection: from now on it is this address's, as
    // if that had come with a connection of its own. Refused where such a connection would be: then it counts for
    // nobody, though the log has the address.
    Connections::Refused passTo(const std::string& address, const std::string& network);
    // It counts for nobody: the request has ended.
    void passBack();
    bool forOthers() const { return for_others_; }
    // The connection that uses the slot from now on. It is stopped at once if all others already are.
    void assign(const std::shared_ptr<Connection>& connection);

private:
    friend Connections;
    enum class Kind { open, reserved, owing };
    ConnectionSlot(Connections& owner, std::string address, std::string network, Kind kind)
        : owner_(owner), address_(std::move(address)), network_(std::move(network)), kind_(kind) {}
    uint32_t& taken() const { // slots of its kind
        return kind_ == Kind::owing ? owner_.owing_ : reserved() ? owner_.reserved_ : owner_.open_;
    }
    Connections& owner_;
    std::string address_, network_; // written by passTo() alone
    const Kind kind_;
    bool for_others_ = false;
    bool counted_ = false;                 // in owner_.per_address_[network_]; guarded by owner_.mutex_
    std::weak_ptr<Connection> connection_; // guarded by owner_.mutex_
};

} // namespace brume::net

#include "server/net/connections.h"

#include <utility>

namespace brume::net {
namespace {

// Networks whose connection rate is remembered. While so many use up their rate at once, others are refused.
constexpr size_t kMostLately = 4096;

} // namespace

bool Connections::comesTooOften(const std::string& network) {
    const auto now = TokenBucket::Time::now();
    auto bucket = accepted_.find(network);
    if (bucket == accepted_.end()) {
        if (accepted_.size() >= kMostLately)
            std::erase_if(accepted_, [&](const auto& one) { return one.second.full(now); });
        if (accepted_.size() >= kMostLately) return true;
        const double burst = std::max(limits_.accept_rate * limits_.burst_s, 1.0);
        bucket = accepted_.emplace(network, TokenBucket(limits_.accept_rate, burst)).first;
    }
    return !bucket->second.take(now);
}

std::unique_ptr<ConnectionSlot> Connections::take(const std::string& address, const std::string& network,
                                                  Refused* why) {
    const std::scoped_lock lock(mutex_);
    const auto refuse = [&](Refused reason) {
        if (why) *why = reason;
        return nullptr;
    };
    if (comesTooOften(network)) return refuse(Refused::rate);
    const auto known = per_address_.find(network);
    const Share share = known == per_address_.end() ? Share{} : known->second;
    const bool reserved = open_ >= limits_.total || share.open >= limits_.per_address;
    if (reserved && (reserved_ >= limits_.reserve || share.reserved >= limits_.reserve_per_address))
        return refuse(Refused::full);
    const auto kind = reserved ? ConnectionSlot::Kind::reserved : ConnectionSlot::Kind::open;
    auto slot = add(std::unique_ptr<ConnectionSlot>(new ConnectionSlot(*this, address, network, kind)));
    count(*slot);
    return slot;
}

std::unique_ptr<ConnectionSlot> Connections::takeForOthers(const std::string& address, const std::string& network) {
    const std::scoped_lock lock(mutex_);
    const bool reserved = open_ >= limits_.total;
    if (reserved && reserved_ >= limits_.reserve) return nullptr;
    const auto kind = reserved ? ConnectionSlot::Kind::reserved : ConnectionSlot::Kind::open;
    auto slot = add(std::unique_ptr<ConnectionSlot>(new ConnectionSlot(*this, address, network, kind)));
    slot->for_others_ = true;
    return slot;
}

std::unique_ptr<ConnectionSlot> Connections::takeOwing(const std::string& address, const std::string& network) {
    const std::scoped_lock lock(mutex_);
    if (owing_ >= limits_.total + limits_.reserve) return nullptr;
    const auto kind = ConnectionSlot::Kind::owing;
    return add(std::unique_ptr<ConnectionSlot>(new ConnectionSlot(*this, address, network, kind)));
}

std::unique_ptr<ConnectionSlot> Connections::add(std::unique_ptr<ConnectionSlot> slot) {
    slots_.insert(slot.get());
    ++slot->taken();
    return slot;
}

void Connections::count(ConnectionSlot& slot) {
    Share& share = per_address_[slot.network_];
    ++(slot.reserved() ? share.reserved : share.open);
    slot.counted_ = true;
}

void Connections::discount(ConnectionSlot& slot) {
    if (!std::exchange(slot.counted_, false)) return;
    const auto here = per_address_.find(slot.network_);
    --(slot.reserved() ? here->second.reserved : here->second.open);
    if (here->second.open + here->second.reserved == 0) per_address_.erase(here);
}

Connections::Refused ConnectionSlot::passTo(const std::string& address, const std::string& network) {
    const std::scoped_lock lock(owner_.mutex_);
    owner_.discount(*this);
    address_ = address;
    network_ = network;
    if (owner_.comesTooOften(network)) return Connections::Refused::rate;
    const auto known = owner_.per_address_.find(network);
    const auto share = known == owner_.per_address_.end() ? Connections::Share{} : known->second;
    const bool full =
        reserved() ? share.reserved >= owner_.limits_.reserve_per_address : share.open >= owner_.limits_.per_address;
    if (full) return Connections::Refused::full;
    owner_.count(*this);
    return Connections::Refused::nothing;
}

void ConnectionSlot::passBack() {
    const std::scoped_lock lock(owner_.mutex_);
    owner_.discount(*this);
}

ConnectionSlot::~ConnectionSlot() {
    const std::scoped_lock lock(owner_.mutex_);
    owner_.slots_.erase(this);
    owner_.discount(*this);
    --taken();
    if (owner_.slots_.empty()) owner_.emptied_.notify_all();
}

void ConnectionSlot::assign(const std::shared_ptr<Connection>& connection) {
    bool stopped;
    {
        const std::scoped_lock lock(owner_.mutex_);
        connection_ = connection;
        stopped = owner_.stopped_;
    }
    if (stopped) connection->stop();
}

std::vector<std::shared_ptr<Connection>> Connections::open() {
    std::vector<std::shared_ptr<Connection>> all;
    const std::scoped_lock lock(mutex_);
    for (const ConnectionSlot* slot : slots_)
        if (auto connection = slot->connection_.lock()) all.push_back(std::move(connection));
    return all;
}

void Connections::setLimits(const Limits& limits) {
    const std::scoped_lock lock(mutex_);
    if (limits.accept_rate != limits_.accept_rate) accepted_.clear(); // token buckets have the old rate
    limits_ = limits;
}

void Connections::stopAll() {
    {
        const std::scoped_lock lock(mutex_);
        stopped_ = true;
    }
    for (const auto& connection : open()) connection->stop();
}

void Connections::killAll() {
    for (const auto& connection : open()) connection->kill();
}

bool Connections::waitUntilEmpty(std::chrono::steady_clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    return emptied_.wait_until(lock, deadline, [&] { return slots_.empty(); });
}

} // namespace brume::net

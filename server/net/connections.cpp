#include "server/net/connections.h"

namespace brume::net {
namespace {

constexpr size_t kMostLately = 4096; // addresses that are all busy at once: a flood from everywhere, and no more are let in

} // namespace

bool Connections::comesTooOften(const std::string& network) {
    const auto now = TokenBucket::Time::now();
    auto bucket = accepted_.find(network);
    if (bucket == accepted_.end()) {
        if (accepted_.size() >= kMostLately) std::erase_if(accepted_, [&](const auto& one) { return one.second.full(now); });
        if (accepted_.size() >= kMostLately) return true;
        const double burst = std::max(limits_.accept_rate * limits_.burst_s, 1.0);
        bucket = accepted_.emplace(network, TokenBucket(limits_.accept_rate, burst)).first;
    }
    return !bucket->second.take(now);
}

std::unique_ptr<Connections::Place> Connections::take(const std::string& address, const std::string& network, Refused* why) {
    const std::scoped_lock lock(mutex_);
    const auto refuse = [&](Refused reason) {
        if (why) *why = reason;
        return nullptr;
    };
    if (comesTooOften(network)) return refuse(Refused::rate);
    if (places_.size() >= limits_.total) return refuse(Refused::room);
    const auto known = per_address_.find(network);
    if (known != per_address_.end() && known->second >= limits_.per_address) return refuse(Refused::room);
    ++per_address_[network];
    std::unique_ptr<Place> place(new Place(*this, address, network));
    places_.insert(place.get());
    return place;
}

Connections::Place::~Place() {
    const std::scoped_lock lock(owner_.mutex_);
    owner_.places_.erase(this);
    const auto here = owner_.per_address_.find(network_);
    if (--here->second == 0) owner_.per_address_.erase(here);
    if (owner_.places_.empty()) owner_.emptied_.notify_all();
}

void Connections::Place::occupy(const std::shared_ptr<Connection>& connection) {
    bool stopped;
    {
        const std::scoped_lock lock(owner_.mutex_);
        occupant_ = connection;
        stopped = owner_.stopped_;
    }
    if (stopped) connection->stop();
}

std::vector<std::shared_ptr<Connection>> Connections::occupants() {
    std::vector<std::shared_ptr<Connection>> all;
    const std::scoped_lock lock(mutex_);
    for (const Place* place : places_)
        if (auto connection = place->occupant_.lock()) all.push_back(std::move(connection));
    return all;
}

void Connections::setLimits(const Limits& limits) {
    const std::scoped_lock lock(mutex_);
    if (limits.accept_rate != limits_.accept_rate) accepted_.clear(); // their buckets have the old rate
    limits_ = limits;
}

void Connections::stopAll() {
    {
        const std::scoped_lock lock(mutex_);
        stopped_ = true;
    }
    for (const auto& connection : occupants()) connection->stop();
}

void Connections::killAll() {
    for (const auto& connection : occupants()) connection->kill();
}

bool Connections::waitUntilEmpty(std::chrono::steady_clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    return emptied_.wait_until(lock, deadline, [&] { return places_.empty(); });
}

} // namespace brume::net

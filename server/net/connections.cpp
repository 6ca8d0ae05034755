#include "server/net/connections.h"

namespace brume::net {

std::unique_ptr<Connections::Place> Connections::take(const std::string& address) {
    const std::scoped_lock lock(mutex_);
    if (places_.size() >= max_total_) return nullptr;
    uint32_t& here = per_address_[address];
    if (here >= max_per_address_) return nullptr;
    ++here;
    std::unique_ptr<Place> place(new Place(*this, address));
    places_.insert(place.get());
    return place;
}

Connections::Place::~Place() {
    const std::scoped_lock lock(owner_.mutex_);
    owner_.places_.erase(this);
    const auto here = owner_.per_address_.find(address_);
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

void Connections::setLimits(uint32_t max_total, uint32_t max_per_address) {
    const std::scoped_lock lock(mutex_);
    max_total_ = max_total;
    max_per_address_ = max_per_address;
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

#include "server/net/places.h"

#include <algorithm>

#include <fmt/format.h>

namespace brume::net {

Places::Taken Places::take(const std::string& owner, uint32_t most) {
    const uint32_t share = std::max(uint32_t(uint64_t(most) * 3 / 4), 1u);
    const std::scoped_lock lock(mutex_);
    if (all_ >= most) return {nullptr, fmt::format("{} {}, the most at a time", most, taken_)};
    uint32_t& mine = per_owner_[owner];
    if (mine >= share)
        return {nullptr, fmt::format("{} {} for your address or token name, the most of {}", share, taken_, most)};
    ++mine;
    ++all_;
    return {std::make_unique<Place>(*this, owner), ""};
}

Places::Place::~Place() {
    const std::scoped_lock lock(places_.mutex_);
    --places_.all_;
    const auto mine = places_.per_owner_.find(owner_);
    if (--mine->second == 0) places_.per_owner_.erase(mine);
}

} // namespace brume::net

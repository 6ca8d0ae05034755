// The pings of one connection that wait for their answer.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>

#include "server/viewer/frame.h"

namespace brume::net {

class Pings {
public:
    // True if another may be sent.
    bool due(Clock::time_point now) {
        while (!sent_.empty() && now - sent_.front().at > kLost) sent_.pop_front();
        return sent_.size() < kMost && (sent_.empty() || now - sent_.back().at >= kEvery);
    }
    // The number of one that is sent now.
    uint32_t send(Clock::time_point now) {
        sent_.push_back({++last_, now});
        return last_;
    }
    // The round trip of this one, which is answered now, and with it all before. Nothing if it is not known.
    std::optional<Clock::duration> answer(uint32_t number, Clock::time_point now) {
        const auto one = std::find_if(sent_.begin(), sent_.end(), [&](const Ping& p) { return p.number == number; });
        if (one == sent_.end()) return {};
        const Clock::duration round_trip = now - one->at;
        sent_.erase(sent_.begin(), one + 1);
        return round_trip;
    }

private:
    static constexpr auto kEvery = std::chrono::milliseconds(200);
    static constexpr auto kLost = std::chrono::seconds(10);
    static constexpr size_t kMost = 8;
    struct Ping {
        uint32_t number;
        Clock::time_point at;
    };
    std::deque<Ping> sent_;
    uint32_t last_ = 0;
};

} // namespace brume::net

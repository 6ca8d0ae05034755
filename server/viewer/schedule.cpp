#include "server/viewer/schedule.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace brume {
namespace {

using Millis = std::chrono::duration<double, std::milli>;

constexpr double kNewestPart = 0.2; // weight of the newest sample
constexpr double kWorthIt = 1.5;    // one batch of all viewers may take so many budgets before it is split into two
constexpr std::chrono::seconds kActive{1}, kForget{10};

void smooth(double& value, double sample) { value = value == 0 ? sample : value + kNewestPart * (sample - value); }

} // namespace

// Who demands no more than an equal part of what is left gets all of it, which leaves more for the others.
double fairLevel(std::span<const double> demands, double capacity) {
    for (double level = 0;;) {
        double left = capacity;
        size_t others = 0;
        for (const double demand : demands) {
            if (demand <= level)
                left -= demand;
            else
                ++others;
        }
        if (others == 0) return std::numeric_limits<double>::infinity();
        const double next = left / double(others);
        if (!(next > level)) return level; // also where it is no number
        level = next;
    }
}

void Schedule::stay(std::span<const uint32_t> viewers) {
    std::erase_if(turns_,
                  [&](const auto& one) { return !std::binary_search(viewers.begin(), viewers.end(), one.first); });
}

void Schedule::took(uint32_t viewer, double pixels, double ms, bool usual) {
    if (pixels <= 0) return;
    if (usual) smooth(ms_per_pixel_, ms / pixels);
    if (const auto turn = turns_.find(viewer); turn != turns_.end()) smooth(turn->second.ms_per_pixel, ms / pixels);
}

void Schedule::sharedTook(double ms) { smooth(shared_ms_, ms); }

void Schedule::finerTook(uint32_t viewer, double pixels, double ms) {
    if (pixels <= 0 || ms <= 0) return;
    const double most = ms / pixels;
    if (most < ms_per_pixel_) smooth(ms_per_pixel_, most);
    const auto turn = turns_.find(viewer);
    if (turn != turns_.end() && most < turn->second.ms_per_pixel) turn->second.ms_per_pixel = most;
}

double Schedule::predict(uint32_t viewer, double pixels) const {
    const auto turn = turns_.find(viewer);
    return pixels * (turn != turns_.end() && turn->second.ms_per_pixel > 0 ? turn->second.ms_per_pixel : ms_per_pixel_);
}

double Schedule::predictPart(uint32_t viewer, const Turn& turn) const {
    return predict(viewer, turn.pixels) / turn.sharers;
}

double Schedule::predictPart(uint32_t viewer) const {
    const auto turn = turns_.find(viewer);
    return turn == turns_.end() ? 0 : predictPart(viewer, turn->second);
}

// The most of the device that a viewer gets: 1 is all of it.
double Schedule::fairPart(Clock::time_point now) {
    demands_.clear();
    for (const auto& [viewer, turn] : turns_)
        if (now - turn.seen <= kActive)
            demands_.push_back(std::min(predictPart(viewer, turn) / std::max(turn.every_ms, 1e-3), 1.0));
    active_ = uint32_t(demands_.size());
    return std::min(fairLevel(demands_, 1), 1.0);
}

void Schedule::setTurns(std::span<const DrawRequest> requests, Clock::time_point now, Clock::duration tick) {
    const double part = fairPart(now);
    turn_of_.clear();
    deadlines_.clear();
    for (const DrawRequest& request : requests) {
        const Turn& turn = turns_[request.viewer];
        const double ms = predictPart(request.viewer, turn); // 0 where nothing is known, and then of `part`, too
        const auto own = std::min(Millis(part > 0 ? ms / part : 0), Millis(kForget));
        const auto interval =
            std::max<Clock::duration>(tick * request.every, std::chrono::duration_cast<Clock::duration>(own));
        const bool drawn = turn.began != Clock::time_point{};
        turn_of_.push_back(drawn ? std::max(turn.began + interval, turn.since) : turn.since);
        deadlines_.push_back(turn_of_.back() + interval);
    }
}

std::span<const uint32_t> Schedule::choose(std::span<const DrawRequest> requests, const Limits& limits,
                                           Clock::time_point now, Clock::duration tick) {
    sharers_.assign(requests.size(), 0);
    for (const DrawRequest& request : requests) ++sharers_[request.like];
    for (const DrawRequest& request : requests) {
        Turn& turn = turns_[request.viewer];
        turn.sharers = sharers_[request.like];
        if (!turn.waits) turn.waits = true, turn.since = now;
        turn.seen = now;
        turn.pixels = request.pixels;
        turn.every_ms = Millis(tick * request.every).count();
    }
    std::erase_if(turns_, [&](const auto& one) { return now - one.second.seen > kForget; });
    setTurns(requests, now, tick);
    order_.resize(requests.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::stable_sort(order_.begin(), order_.end(), [&](uint32_t a, uint32_t b) {
        const bool a_waits = turn_of_[a] > now, b_waits = turn_of_[b] > now;
        return a_waits != b_waits ? b_waits : deadlines_[a] < deadlines_[b];
    });

    const auto cost = [&](const DrawRequest& request) {
        return (request.alone ? 1 : limits.dearer) * predict(request.viewer, request.pixels);
    };
    const auto fill = [&](double budget) {
        chosen_.clear();
        drawn_.assign(requests.size(), 0);
        double ms = shared_ms_;
        uint32_t eyes = 0;
        uint64_t bytes = 0;
        for (const uint32_t number : order_) {
            const DrawRequest& request = requests[number];
            if (!drawn_[request.like]) {
                const double more = cost(request);
                const bool first = chosen_.empty(), in_turn = active_ < 2 || turn_of_[number] <= now;
                if (request.alone && !(first && in_turn)) continue;
                if (ms + more > budget && !(first && in_turn)) continue;
                if (eyes + request.eyes > limits.eyes || (!first && bytes + request.bytes > limits.bytes)) continue;
                ms += more;
                eyes += request.eyes;
                bytes += request.bytes;
                drawn_[request.like] = 1;
            }
            chosen_.push_back(number);
            if (request.alone) break;
        }
        return ms;
    };
    full_batch_ms_ = shared_ms_;
    for (uint32_t number = 0; number < requests.size(); ++number)
        if (requests[number].like == number && !requests[number].alone) full_batch_ms_ += cost(requests[number]);
    chosen_ms_ = fill(full_batch_ms_ <= kWorthIt * limits.budget_ms ? full_batch_ms_ + 1 : limits.budget_ms);
    someone_waits_ = false;
    for (const uint32_t number : order_)
        someone_waits_ |= turn_of_[number] <= now && std::ranges::find(chosen_, number) == chosen_.end();
    for (const uint32_t number : chosen_) {
        Turn& turn = turns_[requests[number].viewer];
        turn.waits = false;
        turn.began = std::min(turn_of_[number], now); // before its turn: in time that nobody needs
    }
    return chosen_;
}

} // namespace brume

#include "server/viewer/schedule.h"

#include <algorithm>
#include <numeric>

namespace brume {
namespace {

using Millis = std::chrono::duration<double, std::milli>;

constexpr double kSmoothing = 0.2; // weight of the newest sample
constexpr double kWorthIt = 1.5;   // one batch of all viewers may take so many budgets before it is split into two
constexpr std::chrono::seconds kLongest{1}, kActive{1}, kForget{10};

void smooth(double& value, double sample) { value = value == 0 ? sample : value + kSmoothing * (sample - value); }

} // namespace

void Schedule::took(uint32_t viewer, double pixels, double ms) {
    if (pixels <= 0) return;
    smooth(ms_per_pixel_, ms / pixels);
    if (const auto turn = turns_.find(viewer); turn != turns_.end()) smooth(turn->second.ms_per_pixel, ms / pixels);
}

void Schedule::sharedTook(double ms) { smooth(shared_ms_, ms); }

double Schedule::predict(uint32_t viewer, double pixels) const {
    const auto turn = turns_.find(viewer);
    return pixels * (turn != turns_.end() && turn->second.ms_per_pixel > 0 ? turn->second.ms_per_pixel : ms_per_pixel_);
}

double Schedule::predict(uint32_t viewer) const {
    const auto turn = turns_.find(viewer);
    return turn == turns_.end() ? 0 : predict(viewer, turn->second.pixels);
}

Clock::time_point Schedule::deadline(const DrawRequest& request, Clock::duration tick) {
    const Turn& turn = turns_[request.viewer];
    if (turn.drawn == Clock::time_point{}) return turn.since;
    const auto own = std::chrono::duration_cast<Clock::duration>(Millis(predict(request.viewer, request.pixels)));
    const Clock::duration most = std::max<Clock::duration>(kLongest, 2 * own);
    const Clock::duration interval = std::min(std::max<Clock::duration>(tick * request.every, own * active_), most);
    return std::max(turn.drawn + interval, turn.since);
}

std::span<const uint32_t> Schedule::choose(std::span<const DrawRequest> requests, const Limits& limits,
                                           Clock::time_point now, Clock::duration tick) {
    for (const DrawRequest& request : requests) {
        Turn& turn = turns_[request.viewer];
        if (!turn.waits) turn.waits = true, turn.since = now;
        turn.seen = now;
        turn.pixels = request.pixels;
    }
    std::erase_if(turns_, [&](const auto& one) { return now - one.second.seen > kForget; });
    active_ = uint32_t(
        std::count_if(turns_.begin(), turns_.end(), [&](const auto& one) { return now - one.second.seen <= kActive; }));

    deadlines_.clear();
    for (const DrawRequest& request : requests) deadlines_.push_back(deadline(request, tick));
    order_.resize(requests.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](uint32_t a, uint32_t b) { return deadlines_[a] < deadlines_[b]; });

    const auto cost = [&](const DrawRequest& request) {
        return limits.dearer * predict(request.viewer, request.pixels);
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
                const bool alone = chosen_.empty(), in_turn = active_ < 2 || deadlines_[number] <= now;
                if (ms + more > budget && !(alone && in_turn)) continue;
                if (eyes + request.eyes > limits.eyes || (!alone && bytes + request.bytes > limits.bytes)) continue;
                ms += more;
                eyes += request.eyes;
                bytes += request.bytes;
                drawn_[request.like] = 1;
            }
            chosen_.push_back(number);
        }
        return ms;
    };
    full_batch_ms_ = shared_ms_;
    for (uint32_t number = 0; number < requests.size(); ++number)
        if (requests[number].like == number) full_batch_ms_ += cost(requests[number]);
    chosen_ms_ = fill(full_batch_ms_ <= kWorthIt * limits.budget_ms ? full_batch_ms_ + 1 : limits.budget_ms);
    for (const uint32_t number : chosen_) {
        Turn& turn = turns_[requests[number].viewer];
        turn.waits = false;
        turn.drawn = now;
    }
    return chosen_;
}

} // namespace brume

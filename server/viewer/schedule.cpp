#include "server/viewer/schedule.h"

#include <algorithm>
#include <numeric>

namespace brume {
namespace {

using Millis = std::chrono::duration<double, std::milli>;

constexpr double kSmoothing = 0.2; // weight of the newest sample
constexpr double kWorthIt = 1.5;   // budgets that a batch of all may take rather than be two batches
constexpr std::chrono::seconds kLongest{1}, kActive{1}, kForget{10};

void smooth(double& value, double sample) { value = value == 0 ? sample : value + kSmoothing * (sample - value); }

} // namespace

void Schedule::took(uint32_t viewer, double pixels, double ms) {
    if (pixels <= 0) return;
    smooth(ms_per_pixel_, ms / pixels);
    if (const auto seat = seats_.find(viewer); seat != seats_.end()) smooth(seat->second.ms_per_pixel, ms / pixels);
}

void Schedule::sharedTook(double ms) { smooth(shared_ms_, ms); }

double Schedule::predict(uint32_t viewer, double pixels) const {
    const auto seat = seats_.find(viewer);
    return pixels * (seat != seats_.end() && seat->second.ms_per_pixel > 0 ? seat->second.ms_per_pixel : ms_per_pixel_);
}

double Schedule::predict(uint32_t viewer) const {
    const auto seat = seats_.find(viewer);
    return seat == seats_.end() ? 0 : predict(viewer, seat->second.pixels);
}

Clock::time_point Schedule::deadline(const Wish& wish, Clock::duration tick) {
    const Seat& seat = seats_[wish.viewer];
    if (seat.drawn == Clock::time_point{}) return seat.since;
    const auto own = std::chrono::duration_cast<Clock::duration>(Millis(predict(wish.viewer, wish.pixels)));
    const Clock::duration most = std::max<Clock::duration>(kLongest, 2 * own);
    const Clock::duration interval = std::min(std::max<Clock::duration>(tick * wish.every, own * active_), most);
    return std::max(seat.drawn + interval, seat.since);
}

std::span<const uint32_t> Schedule::choose(std::span<const Wish> wishes, const Limits& limits, Clock::time_point now,
                                           Clock::duration tick) {
    for (const Wish& wish : wishes) {
        Seat& seat = seats_[wish.viewer];
        if (!seat.waits) seat.waits = true, seat.since = now;
        seat.seen = now;
        seat.pixels = wish.pixels;
    }
    std::erase_if(seats_, [&](const auto& one) { return now - one.second.seen > kForget; });
    active_ =
        uint32_t(std::count_if(seats_.begin(), seats_.end(), [&](const auto& one) { return now - one.second.seen <= kActive; }));

    deadlines_.clear();
    for (const Wish& wish : wishes) deadlines_.push_back(deadline(wish, tick));
    order_.resize(wishes.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::stable_sort(order_.begin(), order_.end(), [&](uint32_t a, uint32_t b) { return deadlines_[a] < deadlines_[b]; });

    const auto cost = [&](const Wish& wish) { return limits.dearer * predict(wish.viewer, wish.pixels); };
    const auto fill = [&](double budget) {
        chosen_.clear();
        drawn_.assign(wishes.size(), 0);
        double ms = shared_ms_;
        uint32_t eyes = 0;
        uint64_t bytes = 0;
        for (const uint32_t number : order_) {
            const Wish& wish = wishes[number];
            if (!drawn_[wish.like]) {
                const double more = cost(wish);
                const bool alone = chosen_.empty(), in_turn = active_ < 2 || deadlines_[number] <= now;
                if (ms + more > budget && !(alone && in_turn)) continue;
                if (eyes + wish.eyes > limits.eyes || (!alone && bytes + wish.bytes > limits.bytes)) continue;
                ms += more;
                eyes += wish.eyes;
                bytes += wish.bytes;
                drawn_[wish.like] = 1;
            }
            chosen_.push_back(number);
        }
        return ms;
    };
    whole_ms_ = shared_ms_;
    for (uint32_t number = 0; number < wishes.size(); ++number)
        if (wishes[number].like == number) whole_ms_ += cost(wishes[number]);
    chosen_ms_ = fill(whole_ms_ <= kWorthIt * limits.budget_ms ? whole_ms_ + 1 : limits.budget_ms);
    for (const uint32_t number : chosen_) {
        Seat& seat = seats_[wishes[number].viewer];
        seat.waits = false;
        seat.drawn = now;
    }
    return chosen_;
}

} // namespace brume

#include "server/viewer/history.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace brume {
namespace {

constexpr std::chrono::seconds kRateOver{3};

} // namespace

void History::add(const Stages& stages, Clock::time_point now) { ring_[frames_++ % kFrames] = {stages, now}; }

History::Percentiles History::of(size_t stage) const {
    std::vector<float> sorted;
    for (size_t i = 0; i < std::min(frames_, kFrames); ++i)
        if (const float ms = ring_[i].stages[stage]; !std::isnan(ms)) sorted.push_back(ms);
    if (sorted.empty()) return {};
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double part) {
        return sorted[std::max(size_t(std::ceil(part * double(sorted.size()))), size_t(1)) - 1];
    };
    return {at(0.5), at(0.95), at(0.99)};
}

float History::rate(Clock::time_point now) const {
    const size_t count = std::min(frames_, kFrames);
    Clock::time_point oldest = now - kRateOver;
    // With more frames than the ring holds, the rate is that of the frames in the ring.
    if (frames_ > kFrames) oldest = std::max(oldest, ring_[frames_ % kFrames].at);
    const auto newer = std::count_if(ring_.begin(), ring_.begin() + std::ptrdiff_t(count),
                                     [&](const Sample& s) { return s.at > oldest; });
    const float seconds = std::chrono::duration<float>(now - oldest).count();
    return seconds > 0 ? float(newer) / seconds : 0;
}

} // namespace brume

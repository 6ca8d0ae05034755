#include "server/viewer/quality.h"

namespace brume {
namespace {

constexpr std::chrono::milliseconds kActEvery{250}, kCleanFor{1000};
constexpr float kQueueTooLong = 50, kQueueClean = 20; // ms

} // namespace

QualityStep QualityControl::stepAt(uint32_t level) {
    constexpr QualityStep kAll[kSteps] = {{100, false, 1}, {65, false, 1}, {52, false, 1}, {40, false, 1},
                                          {40, true, 1},   {40, true, 2},  {40, true, 4}};
    return kAll[std::min(level, kSteps - 1)];
}

bool QualityControl::look(const Look& seen, Clock::time_point now) {
    seen_ = {std::max(seen_.queue_ms, seen.queue_ms), seen_.held_back || seen.held_back, seen_.superseded || seen.superseded};
    if (seen_.queue_ms > kQueueClean || seen_.held_back || seen_.superseded) clean_since_ = now;
    if (now - acted_ < kActEvery) return false;
    const uint32_t before = level_;
    const bool bad = seen_.queue_ms > kQueueTooLong || seen_.held_back || seen_.superseded;
    if (bad && level_ + 1 < kSteps) {
        ++level_;
    } else if (!bad && level_ > 0 && now - clean_since_ >= kCleanFor) {
        --level_;
        clean_since_ = now; // the next step needs its own second
    }
    acted_ = now;
    seen_ = {};
    return level_ != before;
}

} // namespace brume

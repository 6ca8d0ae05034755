#include "server/plan/overload.h"

#include <algorithm>

namespace brume {
namespace {

using namespace std::chrono_literals;
constexpr auto kUp = 1s, kPause = 1s;
constexpr std::chrono::seconds kDown = 5s, kMostDown = 20min;
constexpr auto kHeld = 10s; // after a step down: it did not hold if the level rises sooner
constexpr double kSpare = 0.8;

} // namespace

double Overload::median() const {
    auto sorted = newest_;
    const auto end = sorted.begin() + std::min(frames_, sorted.size()),
               middle = sorted.begin() + (end - sorted.begin()) / 2;
    std::nth_element(sorted.begin(), middle, end);
    return *middle;
}

bool Overload::took(double ms, double restored, Time now) {
    const auto began = now - std::chrono::duration_cast<Time::duration>(std::chrono::duration<double, std::milli>(ms));
    if (began - last_ > kPause) {
        long_ = short_ = false;
        frames_ = 0;
    }
    last_ = now;
    newest_[frames_++ % newest_.size()] = ms;
    const bool too_long = ms > budget_ms_, would_fit = level_ > 0 && median() * restored < kSpare * budget_ms_;
    if (too_long && !long_) long_since_ = now;
    if (would_fit && !short_) short_since_ = now;
    long_ = too_long;
    short_ = would_fit;
    if (long_ && now - long_since_ >= kUp) {
        // What was predicted to fit did not: it is tried again after twice the time.
        down_ = now - fell_ < kHeld ? std::min(2 * down_, kMostDown) : kDown;
        ++level_;
    } else if (short_ && now - short_since_ >= down_) {
        --level_;
        fell_ = now;
    } else {
        return false;
    }
    long_ = short_ = false;
    frames_ = 0; // what comes is made with another plan
    return true;
}

} // namespace brume

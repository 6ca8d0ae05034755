#include "server/plan/overload.h"

namespace brume {
namespace {

using namespace std::chrono_literals;
constexpr auto kUp = 1s, kDown = 5s, kPause = 1s;
constexpr double kSpare = 0.8;

} // namespace

bool Overload::took(double ms, double restored, Time now) {
    if (now - last_ > kPause) long_ = short_ = false;
    last_ = now;
    const bool too_long = ms > budget_ms_, would_fit = level_ > 0 && ms * restored < kSpare * budget_ms_;
    if (too_long && !long_) long_since_ = now;
    if (would_fit && !short_) short_since_ = now;
    long_ = too_long;
    short_ = would_fit;
    if (long_ && now - long_since_ >= kUp) {
        ++level_;
    } else if (short_ && now - short_since_ >= kDown) {
        --level_;
    } else {
        return false;
    }
    long_ = short_ = false;
    return true;
}

} // namespace brume

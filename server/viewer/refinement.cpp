#include "server/viewer/refinement.h"

namespace brume {
namespace {

constexpr double kToBegin = 0.8;
constexpr std::chrono::seconds kPause{5};

} // namespace

bool Refinement::next(const Observation& seen, Clock::time_point now) {
    const double most = part_ * seen.budget_ms;
    if (!seen.rests || part_ <= 0) return on_ = false;
    if (on_ && measured_ms_ > most) {
        on_ = false;
        stopped_ = now;
    } else if (!on_ && seen.plain_ms > 0 && seen.plain_ms * seen.dearer <= kToBegin * most &&
               (stopped_ == Clock::time_point{} || now - stopped_ >= kPause)) {
        on_ = true;
        measured_ms_ = 0;
    }
    return on_;
}

} // namespace brume

#include "server/metrics/busy.h"

#include <chrono>

namespace brume {
namespace {

int64_t presentSecond() {
    using namespace std::chrono;
    return duration_cast<seconds>(steady_clock::now().time_since_epoch()).count();
}

} // namespace

void Busy::add(double ms) {
    const std::scoped_lock lock(mutex_);
    const int64_t now = presentSecond();
    Slot& slot = slots_[size_t(now) % slots_.size()];
    if (slot.second != now) slot = {now, 0};
    slot.ms += ms;
}

double Busy::ratio() const {
    const std::scoped_lock lock(mutex_);
    const int64_t now = presentSecond();
    double ms = 0;
    for (const Slot& slot : slots_)
        if (slot.second < now && slot.second >= now - kSeconds) ms += slot.ms;
    return ms / (1e3 * double(kSeconds));
}

} // namespace brume

#include "server/loop/device_turns.h"

#include <algorithm>
#include <utility>

namespace brume {
namespace {

// A seat whose turn it is and that does not come has nothing to draw any more.
constexpr std::chrono::milliseconds kComesWithin{20};
constexpr std::chrono::seconds kLately{1};

} // namespace

DeviceTurns::Seat::Seat(DeviceTurns& turns, std::function<void()> wake)
    : turns_(turns), number_([&] {
          const std::scoped_lock lock(turns.mutex_);
          const uint32_t number = turns.next_number_++;
          turns.entries_[number].wake = std::move(wake);
          return number;
      }()) {}

DeviceTurns::Seat::~Seat() {
    const std::scoped_lock lock(turns_.mutex_);
    if (turns_.holder_ == number_) turns_.holder_ = 0;
    turns_.entries_.erase(number_);
    turns_.wakeOthers(number_);
}

// The seat whose turn it is, of those that wait.
DeviceTurns::Entries::iterator DeviceTurns::next(Time now) {
    for (;;) {
        auto least = entries_.end();
        for (auto one = entries_.begin(); one != entries_.end(); ++one)
            if (one->second.waits && (least == entries_.end() || one->second.time < least->second.time)) least = one;
        if (least == entries_.end()) return least;
        Entry& entry = least->second;
        if (entry.offered == Time()) entry.offered = now;
        if (now - entry.offered <= kComesWithin) return least;
        entry.waits = false;
        entry.offered = {};
    }
}

void DeviceTurns::wakeOthers(uint32_t but) {
    for (auto& [number, entry] : entries_)
        if (number != but && entry.waits) entry.wake();
}

// Who had the device has it no more.
void DeviceTurns::book(Time now) {
    Entry& entry = entries_.at(std::exchange(holder_, 0));
    entry.time += std::chrono::duration<double, std::milli>(now - taken_).count() / entry.weight;
}

// Who comes back after a pause has no claim on the time that it did not want.
bool DeviceTurns::Seat::take(double weight, Time now) {
    const std::scoped_lock lock(turns_.mutex_);
    Entry& entry = turns_.entries_.at(number_);
    const bool had = turns_.holder_ == number_;
    if (had) turns_.book(now);
    if (!had && !entry.waits) entry.time = std::max(entry.time, turns_.now_);
    entry.weight = weight;
    entry.waits = true;
    entry.wanted = now;
    if (turns_.holder_ != 0) return false;
    if (turns_.next(now)->first != number_) {
        if (had) turns_.wakeOthers(number_);
        return false;
    }
    turns_.holder_ = number_;
    turns_.taken_ = now;
    turns_.now_ = entry.time;
    entry.waits = false;
    entry.offered = {};
    return true;
}

void DeviceTurns::Seat::give(Time now) {
    const std::scoped_lock lock(turns_.mutex_);
    if (turns_.holder_ != number_) return;
    turns_.book(now);
    turns_.wakeOthers(number_);
}

double DeviceTurns::Seat::part(Time now) const {
    const std::scoped_lock lock(turns_.mutex_);
    double all = 0;
    for (const auto& [number, entry] : turns_.entries_)
        if (number == number_ || now - entry.wanted < kLately) all += entry.weight;
    return turns_.entries_.at(number_).weight / all;
}

} // namespace brume

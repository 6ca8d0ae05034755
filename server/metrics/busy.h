// Busy: how much of the last seconds the device was busy, from what batches report when they are done.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>

namespace brume {

// Thread-safe.
class Busy {
public:
    static constexpr int64_t kSeconds = 10; // whole ones, before the present

    void add(double ms);
    double ratio() const; // 0 ... 1, of those seconds; more where batches overlap

private:
    struct Slot {
        int64_t second = -kSeconds - 1; // time by the monotonic clock
        double ms = 0;
    };
    mutable std::mutex mutex_;
    std::array<Slot, kSeconds + 1> slots_;
};

} // namespace brume

// IdleMemory: says when memory that grew for large pictures lies idle, and is to be given back.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace brume {

// Memory is idle when for a minute less than half of the most was used. So what changes by less, or faster, is not
// freed and allocated again.
class IdleMemory {
public:
    using time_point = std::chrono::steady_clock::time_point;
    static constexpr auto kUnused = std::chrono::minutes(1);

    // So many bytes are used now.
    void use(uint64_t bytes, time_point now) {
        most_ = std::max(most_, bytes);
        if (2 * bytes >= most_) large_ = now;
    }
    // True: for a minute less than half of the most was used. The caller frees all, and the count begins anew.
    bool spare(time_point now) {
        if (most_ == 0 || now - large_ < kUnused) return false;
        most_ = 0;
        return true;
    }

private:
    uint64_t most_ = 0;  // bytes, since memory was given back
    time_point large_{}; // when at least half of that was used last
};

} // namespace brume

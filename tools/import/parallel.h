// A loop over all cores that the process may use. The result must not depend on which core takes which part.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "common/cores.h"

namespace brume::volumes {

// Calls body(i) for each i below `count`. The body must not throw.
template <class Body>
void parallelFor(size_t count, const Body& body) {
    std::atomic<size_t> next = 0;
    const auto work = [&] {
        for (size_t i = next++; i < count; i = next++) body(i);
    };
    std::vector<std::jthread> others;
    const size_t threads = std::min<size_t>(usableCores(), count);
    for (size_t i = 1; i < threads; ++i) others.emplace_back(work);
    work();
}

} // namespace brume::volumes

// Distributes the rows of a picture over threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "common/cores.h"

namespace brume::reference {

// Calls make() once per thread, and the function that it returns for each row. 0 threads: usableCores().
template <typename Make>
void forRows(int height, unsigned threads, const Make& make) {
    std::atomic<int> next_row{0};
    const auto work = [&] {
        auto row = make();
        for (int y = next_row++; y < height; y = next_row++) row(y);
    };
    const unsigned most = static_cast<unsigned>(std::max(height, 1));
    std::vector<std::jthread> workers(std::min(most, threads != 0 ? threads : usableCores()));
    for (std::jthread& worker : workers) worker = std::jthread(work);
}

} // namespace brume::reference

// EncodeWorkers: threads that encode pictures. Jobs start in the order in which they were given.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "server/encode/jpeg.h"

namespace brume {

class EncodeWorkers {
public:
    using Job = std::function<void(JpegEncoder&)>; // a job that throws is logged, and its thread goes on

    // Throws std::system_error if not all threads can be started.
    explicit EncodeWorkers(unsigned threads);
    // Finishes all jobs first.
    ~EncodeWorkers();

    void give(Job job);
    // Every thread frees its scratch memory before its next job.
    void giveBack();
    // Of scratch memory, all threads together.
    uint64_t bytes() const { return bytes_; }

private:
    void work();
    void stop();

    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<Job> jobs_; // bounded: no more than frames in flight
    bool stopping_ = false;
    uint64_t asked_ = 0; // calls of giveBack()
    std::atomic<uint64_t> bytes_{0};
    std::vector<std::jthread> threads_;
};

} // namespace brume

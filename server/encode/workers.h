// EncodeWorkers: threads that encode pictures. Jobs start in the order in which they were given.
#pragma once

#include <condition_variable>
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

    explicit EncodeWorkers(unsigned threads);
    // Finishes all jobs first.
    ~EncodeWorkers();

    void give(Job job);

private:
    void work();

    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<Job> jobs_; // bounded: no more than frames in flight
    bool stopping_ = false;
    std::vector<std::jthread> threads_;
};

} // namespace brume

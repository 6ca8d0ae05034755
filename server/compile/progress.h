// Progress: says in the log that shaders are being compiled, and for how long, while it lives.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

namespace brume {

class Progress {
public:
    Progress();

private:
    std::mutex mutex_;
    std::condition_variable_any woken_;
    std::jthread thread_; // the last member: it uses the others
};

} // namespace brume

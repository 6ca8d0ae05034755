// Progress: how far long work is and how long it will still take, on standard error.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

namespace brume::reference {

// Each line replaces the one before on a terminal; elsewhere there is one every ten seconds. Safe from any thread.
class Progress {
public:
    Progress(std::string what, size_t steps);
    ~Progress(); // ends the line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void done(size_t steps = 1);
    double seconds() const; // since the start

    // "reference of plume: 25 %, 12 s left".
    static std::string text(const std::string& what, double part, double seconds);

private:
    using Clock = std::chrono::steady_clock;
    const std::string what_;
    const size_t steps_;
    const bool terminal_;
    const Clock::time_point begin_ = Clock::now();
    std::atomic<size_t> done_{0};
    std::mutex mutex_; // of what follows
    Clock::time_point told_ = begin_;
};

} // namespace brume::reference

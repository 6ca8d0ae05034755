// Ending: ends the process where it cannot end in order: while it starts or replays, and where the end takes too long.
// A scene may take a minute to load, a shader seconds to compile.
#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <mutex>
#include <string>
#include <thread>

namespace brume {

class Ending {
public:
    // From now on SIGINT and SIGTERM end the process at once, with one line and exit code 128 plus the signal's number.
    // Precondition: `signals`, which have both, are blocked in all threads.
    explicit Ending(const sigset_t& signals);
    // The process ends in order.
    ~Ending();

    // What they end is a server that starts: exit code 0.
    void serves() { serves_ = true; }
    // SIGINT and SIGTERM are somebody else's.
    void started();
    // The process ends after this time, if it has not ended by then, with a warning and exit code 0.
    void within(std::chrono::milliseconds time);
    // Or rather with this line and exit code 1.
    void failed(const std::string& line);

private:
    void cease();

    std::atomic<bool> serves_{false};
    std::mutex mutex_;
    std::string failure_; // guarded by mutex_
    std::jthread thread_;
};

} // namespace brume

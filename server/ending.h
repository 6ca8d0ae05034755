// Ending: ends the process where it cannot end in order: while it starts or replays, and where the end takes too long.
// A scene may take a minute to load, a shader seconds to compile.
#pragma once

#include <chrono>
#include <csignal>
#include <thread>

namespace brume {

class Ending {
public:
    // From now on SIGINT and SIGTERM end the process at once, with one line and exit code 0. Precondition: `signals`,
    // which have both, are blocked in all threads.
    explicit Ending(const sigset_t& signals);
    // The process ends in order.
    ~Ending();

    // SIGINT and SIGTERM are somebody else's.
    void started();
    // The process ends after this time, if it has not ended by then, with a warning and exit code 0.
    void within(std::chrono::milliseconds time);

private:
    void cease();

    std::jthread thread_;
};

} // namespace brume

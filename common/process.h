// A program as a child process: its output is kept, its end is awaited with a deadline, and it never outlives us.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <sys/types.h>

namespace brume {

class Process {
public:
    using milliseconds = std::chrono::milliseconds;
    // Nothing should take this long; a loaded machine with sanitizers may.
    static constexpr milliseconds kPatience{30'000};

    // `environment`: NAME=value sets, NAME alone removes. Throws std::system_error when it cannot be started.
    explicit Process(const std::vector<std::string>& command, const std::vector<std::string>& environment = {});
    ~Process(); // SIGKILL if it still runs
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    pid_t id() const { return pid_; }
    void signal(int number);
    // The exit status, or minus the signal that ended it; nothing when it still runs after `timeout`.
    std::optional<int> exitCode(milliseconds timeout = kPatience);
    // The rest of the first line of stdout that starts so; nothing when the program ends or the time is over before.
    std::optional<std::string> lineStarting(const std::string& prefix, milliseconds timeout = kPatience);

    // All so far; complete once exitCode() has returned one.
    std::string out() const;
    std::string err() const;

private:
    void read(int out, int err);

    pid_t pid_ = -1;
    std::optional<int> exit_code_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::string out_, err_;
    bool closed_ = false; // both pipes are at their end
    std::thread reader_;
};

} // namespace brume

// Process: a program run as a child process. It keeps the output, waits for the end with a deadline, and kills the
// child when it is destroyed.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
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
    // Default deadline: longer than anything takes, also with sanitizers, and where a driver compiles all shaders
    // beside other work.
    static constexpr milliseconds kPatience{120'000};

    // `environment`: NAME=value sets a variable, NAME alone removes it. `on_output` is called on another thread when
    // the program has written something. Throws std::system_error if the program cannot be started.
    explicit Process(const std::vector<std::string>& command, const std::vector<std::string>& environment = {},
                     std::function<void()> on_output = {});
    ~Process(); // sends SIGKILL if it still runs
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    pid_t id() const { return pid_; }
    void signal(int number);
    // Waits for the end. Returns the exit status, or minus the signal that ended it; nothing if it still runs after
    // `timeout`.
    std::optional<int> exitCode(milliseconds timeout = kPatience);
    // Waits for a line of stdout that starts with `prefix`, and returns its rest. Nothing if the program ends or time
    // is over first.
    std::optional<std::string> lineStarting(const std::string& prefix, milliseconds timeout = kPatience);

    // The output so far; complete once exitCode() has returned a status.
    std::string out() const;
    std::string err() const;

private:
    void read(int out, int err);

    const std::function<void()> on_output_;
    pid_t pid_ = -1;
    std::optional<int> exit_code_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::string out_, err_;
    bool closed_ = false; // True: both pipes have ended
    std::thread reader_;
};

} // namespace brume

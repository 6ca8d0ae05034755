#include "server/ending.h"

#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <mutex>

#include <spdlog/spdlog.h>
#include <sys/resource.h>

namespace brume {
namespace {

// A thread must run once more to end. Those of the lowest priority, the driver's among them, would take seconds for it
// where others have work. To raise it takes CAP_SYS_NICE or RLIMIT_NICE: without, it stays.
void hurry() {
    std::error_code error;
    std::filesystem::directory_iterator thread("/proc/self/task", error);
    for (; !error && thread != std::filesystem::directory_iterator(); thread.increment(error))
        ::setpriority(PRIO_PROCESS, id_t(std::strtoul(thread->path().filename().c_str(), nullptr, 10)), 0);
}

[[noreturn]] void endNow(int code) {
    spdlog::default_logger()->flush();
    hurry();
    std::_Exit(code);
}

} // namespace

Ending::Ending(const sigset_t& signals) {
    sigset_t ends;
    sigemptyset(&ends);
    for (const int one : {SIGINT, SIGTERM})
        if (sigismember(&signals, one) == 1) sigaddset(&ends, one);
    thread_ = std::jthread([this, ends](const std::stop_token& stop) {
        constexpr timespec kLook{0, 20'000'000}; // ns
        while (!stop.stop_requested())
            if (const int signal = ::sigtimedwait(&ends, nullptr, &kLook); signal > 0) {
                spdlog::info("stopped");
                endNow(serves_ ? 0 : 128 + signal);
            }
    });
}

Ending::~Ending() { cease(); }

void Ending::cease() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
}

void Ending::started() { cease(); }

void Ending::failed(const std::string& line) {
    const std::scoped_lock lock(mutex_);
    failure_ = line;
}

void Ending::within(std::chrono::milliseconds time) {
    cease();
    thread_ = std::jthread([this, time](const std::stop_token& stop) {
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any ended;
        if (ended.wait_for(lock, stop, time, [&] { return stop.stop_requested(); })) return;
        spdlog::warn("what is under way is left: it takes longer than {} ms", time.count());
        const std::scoped_lock failure(mutex_);
        if (failure_.empty()) endNow(0);
        std::cerr << "brume-server: " << failure_ << std::endl;
        endNow(1);
    });
}

} // namespace brume

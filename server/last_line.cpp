#include "server/last_line.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <system_error>

#include <sys/resource.h>
#include <unistd.h>

namespace brume {
namespace {

constexpr const char* kOutOfMemory =
    "out of memory; use smaller pictures (--max-pixels), fewer viewers or fewer particles, or allow more memory";
constexpr char kFault[] = "brume-server: a library failed where the address space has a limit; allow more memory "
                          "(ulimit -v, LimitAS of systemd)\n";

[[noreturn]] void end(const char* why) {
    std::fprintf(stderr, "brume-server: %s\n", why);
    std::_Exit(1);
}

[[noreturn]] void onTerminate() {
    try {
        if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
    } catch (const std::exception& error) {
        end(lastLine(error));
    } catch (...) { // the next line says all that is known
    }
    end("ended by an error of an unknown kind");
}

void onFault(int /*signal*/) {
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kFault, sizeof kFault - 1);
    ::_exit(1);
}

} // namespace

const char* lastLine(const std::exception& error) {
    if (dynamic_cast<const std::bad_alloc*>(&error)) return kOutOfMemory;
    const auto* system = dynamic_cast<const std::system_error*>(&error);
    if (system && system->code() == std::errc::resource_unavailable_try_again)
        return "no thread can be started: memory, or the number of threads, has a limit; allow more (ulimit -v, -u)";
    return error.what();
}

void endInOneLine() {
    std::set_terminate(onTerminate);
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return; // a core dump tells more
    for (const int fault : {SIGSEGV, SIGBUS, SIGABRT}) std::signal(fault, onFault);
}

} // namespace brume

#include "tools/reference/progress.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace brume::reference {

Progress::Progress(std::string what, size_t steps)
    : what_(std::move(what)), steps_(steps), terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    std::fprintf(stderr, "%s  %s: %.1f s%s\n", terminal_ ? "\r" : "", what_.c_str(), seconds(),
                 terminal_ ? "\x1b[K" : "");
}

double Progress::seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

std::string Progress::text(const std::string& what, double part, double seconds) {
    return fmt::format("{}: {:.0f} %, {:.0f} s left", what, 100 * part,
                       part > 0 ? std::ceil(seconds * (1 - part) / part) : 0);
}

void Progress::done(size_t steps) {
    const size_t all = done_ += steps;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    const auto now = Clock::now();
    if (!lock || now - told_ < (terminal_ ? std::chrono::milliseconds(250) : std::chrono::seconds(10))) return;
    told_ = now;
    const std::string line = text(what_, double(all) / double(steps_), seconds());
    std::fprintf(stderr, terminal_ ? "\r  %s\x1b[K" : "  %s\n", line.c_str());
}

} // namespace brume::reference

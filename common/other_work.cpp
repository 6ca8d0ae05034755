#include "common/other_work.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include <unistd.h>

#include "common/cores.h"

namespace brume {
namespace {

// The numbers of a line, separated by blanks, up to the first that is none.
template <size_t N>
std::array<uint64_t, N> numbersIn(std::string_view text) {
    std::array<uint64_t, N> out{};
    for (uint64_t& one : out) {
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), one);
        if (error != std::errc()) break;
        text.remove_prefix(size_t(end - text.data()));
    }
    return out;
}

std::string textOf(const char* file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return std::move(text).str();
}

} // namespace

CpuTicks readCpuTicks(std::string_view stat, std::string_view self) {
    const size_t name_end = self.rfind(") "); // the name may hold blanks and brackets
    if (!stat.starts_with("cpu ") || name_end == self.npos) return {};
    // user nice system idle iowait irq softirq steal; `guest` is in `user`.
    const auto all = numbersIn<8>(stat.substr(4));
    CpuTicks out;
    for (const uint64_t ticks : all) out.passed += ticks;
    out.busy = all[0] + all[2] + all[5] + all[6] + all[7];
    std::string_view fields = self.substr(name_end + 2);
    for (int skipped = 0; skipped < 11; ++skipped) // from the state to cmajflt
        fields.remove_prefix(std::min(fields.find(' '), fields.size() - 1) + 1);
    const auto own = numbersIn<2>(fields);
    out.own = own[0] + own[1];
    return out;
}

OtherWork::OtherWork() : OtherWork(unsigned(std::max(::sysconf(_SC_NPROCESSORS_ONLN), 1L)), usableCores()) {}

bool OtherWork::disturbs(const CpuTicks& before, const CpuTicks& now) const {
    if (before.passed == 0 || now.passed <= before.passed || all_cores_ < usable_) return false;
    const double all = all_cores_, window = double(now.passed - before.passed) / all;
    const double others = (double(now.busy - before.busy) - double(now.own - before.own)) / window;
    return others > (all - usable_) + 0.1 * usable_;
}

bool OtherWork::disturbs() {
    const CpuTicks now = readCpuTicks(textOf("/proc/stat"), textOf("/proc/self/stat"));
    const bool so = disturbs(last_, now);
    last_ = now;
    return so;
}

} // namespace brume

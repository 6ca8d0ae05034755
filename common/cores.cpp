#include "common/cores.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

#include <sched.h>

namespace brume {
namespace {

namespace fs = std::filesystem;

std::optional<double> numberOf(const fs::path& file) {
    double number = 0;
    return std::ifstream(file) >> number ? std::optional(number) : std::nullopt;
}

// Processors of one group: quota over period. Nothing: it has all.
std::optional<double> quotaOf(const fs::path& group, bool second) {
    if (second) {
        double quota = 0, period = 0; // "max 100000": no number comes first
        if (!(std::ifstream(group / "cpu.max") >> quota >> period) || quota <= 0 || period <= 0) return {};
        return quota / period;
    }
    const auto quota = numberOf(group / "cpu.cfs_quota_us"), period = numberOf(group / "cpu.cfs_period_us");
    if (!quota || !period || *quota <= 0 || *period <= 0) return {}; // -1: no quota
    return *quota / *period;
}

// The least of a group and those around it. Within a container the path may be the host's, of which the mount shows
// the last part alone, at its top.
double leastOf(const fs::path& mount, const fs::path& group, bool second, double least) {
    for (fs::path at = group.relative_path();; at = at.parent_path()) {
        if (const auto quota = quotaOf(mount / at, second)) least = std::min(least, *quota);
        if (at.empty()) return least;
    }
}

bool holdsCpu(const std::string& controllers) {
    for (size_t from = 0; from <= controllers.size();) {
        const size_t end = std::min(controllers.find(',', from), controllers.size());
        if (controllers.compare(from, end - from, "cpu") == 0) return true;
        from = end + 1;
    }
    return false;
}

} // namespace

unsigned coresOfGroups(const fs::path& self, const fs::path& root) {
    constexpr double kAll = 1e6;
    double least = kAll;
    std::ifstream lines(self);
    for (std::string line; std::getline(lines, line);) { // NUMBER:CONTROLLERS:PATH; 0::PATH is the second version
        const size_t first = line.find(':'), second = line.find(':', first == line.npos ? first : first + 1);
        if (second == line.npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1), path = line.substr(second + 1);
        if (controllers.empty()) {
            least = leastOf(root, path, true, least);
            least = leastOf(root / "unified", path, true, least);
        } else if (holdsCpu(controllers)) {
            least = leastOf(root / controllers, path, false, least);
            least = leastOf(root / "cpu", path, false, least);
        }
    }
    return least < kAll ? std::max(unsigned(std::ceil(least)), 1u) : 0;
}

unsigned usableCores() {
    unsigned cores = std::max(std::thread::hardware_concurrency(), 1u);
    cpu_set_t set;
    CPU_ZERO(&set);
    if (::sched_getaffinity(0, sizeof set, &set) == 0) cores = std::max(unsigned(CPU_COUNT(&set)), 1u);
    const unsigned most = coresOfGroups("/proc/self/cgroup", "/sys/fs/cgroup");
    return most > 0 ? std::min(cores, most) : cores;
}

} // namespace brume

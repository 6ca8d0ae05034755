// How many threads of this process can run at once.
#pragma once

#include <filesystem>

namespace brume {

// The processors that the process may run on, at most what its control group and the groups around it have of them
// (cpu.max, or cpu.cfs_quota_us), counted up. At least 1.
unsigned usableCores();

// The processors that the control groups of a process leave it, counted up; 0: as many as there are. `self`: its
// /proc/self/cgroup. `root`: where the groups are mounted, as /sys/fs/cgroup. What is missing or no number bounds
// nothing.
unsigned coresOfGroups(const std::filesystem::path& self, const std::filesystem::path& root);

} // namespace brume

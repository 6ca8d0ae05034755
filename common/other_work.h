// OtherWork: how much of the machine other processes use, so that nothing is learnt from times that they made longer.
#pragma once

#include <cstdint>
#include <string_view>

namespace brume {

// Processor time since the machine's and the process's start, in clock ticks of all cores together.
struct CpuTicks {
    uint64_t passed = 0; // idle or not
    uint64_t busy = 0;   // by processes of usual priority or above, the kernel, and the machines around this one
    uint64_t own = 0;    // by this process
};

// `stat`: the text of /proc/stat, `self`: that of /proc/self/stat. All 0 for other texts.
CpuTicks readCpuTicks(std::string_view stat, std::string_view self);

class OtherWork {
public:
    // `all_cores`: of the machine. `usable`: that this process may use; it does not feel what others do beside those.
    OtherWork(unsigned all_cores, unsigned usable) : all_cores_(all_cores), usable_(usable) {}
    OtherWork(); // the cores of this machine

    // True: since the last look others have used more than a tenth of what this process could. Looks at /proc, some
    // 50 us. False at the first look, and where the system does not tell.
    bool disturbs();
    // Of the time between two looks.
    bool disturbs(const CpuTicks& before, const CpuTicks& now) const;

private:
    const unsigned all_cores_, usable_;
    CpuTicks last_;
};

} // namespace brume

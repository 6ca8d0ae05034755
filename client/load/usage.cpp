#include "client/load/usage.h"

#include <cmath>
#include <ctime>
#include <fstream>
#include <string>

#include <unistd.h>

namespace brume::load {

Usage usage() {
    timespec own{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &own);
    // proc(5): cpu user nice system idle iowait irq softirq steal, in clock ticks since boot.
    std::ifstream file("/proc/stat");
    std::string cpu;
    double user = 0, nice = 0, system = 0, idle = 0, iowait = 0, irq = 0, softirq = 0;
    const bool known = bool(file >> cpu >> user >> nice >> system >> idle >> iowait >> irq >> softirq);
    const double busy = (user + nice + system + irq + softirq) / double(sysconf(_SC_CLK_TCK));
    return {double(own.tv_sec) + double(own.tv_nsec) * 1e-9, known ? busy : NAN};
}

} // namespace brume::load

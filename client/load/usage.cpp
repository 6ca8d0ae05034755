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
    std::ifstream file("/proc/stat");
    return {double(own.tv_sec) + double(own.tv_nsec) * 1e-9, busySeconds(file)};
}

double busySeconds(std::istream& proc_stat) {
    // proc(5): cpu user nice system idle iowait irq softirq steal guest guest_nice, in clock ticks; user and nice
    // have the guests'.
    std::string cpu;
    double user = 0, nice = 0, system = 0, idle = 0, iowait = 0, irq = 0, softirq = 0;
    if (!(proc_stat >> cpu >> user >> nice >> system >> idle >> iowait >> irq >> softirq) || cpu != "cpu") return NAN;
    return (user + nice + system + irq + softirq) / double(sysconf(_SC_CLK_TCK));
}

} // namespace brume::load

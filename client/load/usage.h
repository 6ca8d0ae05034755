// How much processor time this program and its machine spend: programs that share cores slow each other down.
#pragma once

#include <iosfwd>

namespace brume::load {

struct Usage {
    double own_cpu_s = 0; // user and system time of this process
    double busy_s = 0;    // busySeconds() of this machine
};
Usage usage();

// Seconds that all cores together have worked since the machine started, from the text of /proc/stat; NaN when it is
// no such text. A core that is idle, waits for a disk or waits for its host does not work.
double busySeconds(std::istream& proc_stat);

} // namespace brume::load

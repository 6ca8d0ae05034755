// What this program and its machine spend, since processes that share cores share the result.
#pragma once

namespace brume::load {

struct Usage {
    double own_cpu_s = 0; // user and system time of this process
    double busy_s = 0;    // of all cores, whoever used them; NaN where /proc/stat does not say
};
Usage usage();

} // namespace brume::load

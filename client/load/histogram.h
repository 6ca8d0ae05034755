// Percentiles of what a server's histogram counted in a run.
#pragma once

#include <string_view>

#include "client/load/scrape.h"

namespace brume::load {

// The value that `fraction` of the histogram's new samples do not exceed, in the histogram's unit. `before` and `after`
// are the server's series at both ends of the run. Inside a bucket samples count as evenly spread, and those beyond the
// last bound as that bound. NaN: no samples came, the server has no such histogram, or it began anew.
double percentileBetween(const Series& before, const Series& after, std::string_view histogram, double fraction);

} // namespace brume::load

// Series of the process itself, which all rooms share.
#pragma once

#include <vector>

#include <prometheus/metric_family.h>

namespace brume {

// A family of one gauge.
prometheus::MetricFamily gauge(const char* name, const char* help, double value);

// What the program was built of, its memory, processor time and file descriptors as they are now.
std::vector<prometheus::MetricFamily> processFamilies();

} // namespace brume

#include "server/metrics/process.h"

#include <ctime>
#include <filesystem>
#include <fstream>

#include <sys/resource.h>
#include <unistd.h>

namespace brume {
namespace {

namespace pm = prometheus;

// Of the process, as every exporter has them, under the names that dashboards know.
pm::MetricFamily processCpu() {
    timespec spent{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent);
    pm::ClientMetric metric;
    metric.counter.value = double(spent.tv_sec) + double(spent.tv_nsec) * 1e-9;
    return {"process_cpu_seconds_total", "User and system CPU time of all threads.", pm::MetricType::Counter, {metric}};
}

pm::MetricFamily processMemory() {
    double all_pages = 0, resident_pages = 0;
    std::ifstream("/proc/self/statm") >> all_pages >> resident_pages;
    return gauge("process_resident_memory_bytes", "Memory that is in RAM.",
                 resident_pages * double(::sysconf(_SC_PAGESIZE)));
}

pm::MetricFamily openDescriptors() {
    std::error_code error; // none can be opened to count them: as many as there may be
    const auto listed = std::filesystem::directory_iterator("/proc/self/fd", error);
    rlimit most{};
    ::getrlimit(RLIMIT_NOFILE, &most);
    const double count =
        error ? double(most.rlim_cur) : double(std::distance(begin(listed), end(listed)) - 1); // without the list's own
    return gauge("process_open_fds", "Open file descriptors.", count);
}

pm::MetricFamily mostDescriptors() {
    rlimit most{};
    ::getrlimit(RLIMIT_NOFILE, &most);
    return gauge("process_max_fds", "File descriptors that may be open.", double(most.rlim_cur));
}

pm::MetricFamily buildInfo() {
    pm::MetricFamily family = gauge("brume_build_info", "1; what the program was built of.", 1);
#ifdef NDEBUG
    const char* assertions = "off";
#else
    const char* assertions = "on";
#endif
#ifdef __clang__
    const char* compiler = "clang " __clang_version__;
#else
    const char* compiler = "gcc " __VERSION__;
#endif
    family.metric[0].label = {{"version", BRUME_VERSION}, {"compiler", compiler}, {"assertions", assertions}};
    return family;
}

} // namespace

prometheus::MetricFamily gauge(const char* name, const char* help, double value) {
    pm::ClientMetric metric;
    metric.gauge.value = value;
    return {name, help, pm::MetricType::Gauge, {metric}};
}

std::vector<prometheus::MetricFamily> processFamilies() {
    return {buildInfo(), processCpu(), processMemory(), openDescriptors(), mostDescriptors()};
}

} // namespace brume

// brume-load: many viewers of one brume server; measures what each gets and costs. ./dev load builds and runs it.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <thread>

#include <fmt/format.h>

#include "client/load/crowd.h"
#include "client/load/report.h"
#include "client/load/server.h"
#include "client/load/usage.h"

namespace {

using namespace brume::load;
using brume::client::Interrupt;

std::string machine() {
    double average = NAN;
    getloadavg(&average, 1);
    return fmt::format("{} cores, load average {:.2f} before the first run", std::thread::hardware_concurrency(),
                       average);
}

// One number of viewers, from hello to goodbye.
Run measure(const Options& options, const Server& server, uint32_t viewers, Interrupt& interrupt, Report& report) {
    Crowd crowd(options, server.endpoint(), viewers, interrupt);
    const double warm_up_s = crowd.enter();
    Series before, after;
    crowd.during([&] { before = server.counters(); });
    const Usage began = usage();
    Run run = crowd.watch(options.seconds);
    const Usage ended = usage();
    crowd.during([&] { after = server.counters(); });
    run.server = costBetween(before, after);
    run.warm_up_s = warm_up_s;
    run.own_cpu_s = ended.own_cpu_s - began.own_cpu_s;
    run.machine_busy_s = ended.busy_s - began.busy_s;
    const auto& granted = crowd.granted();
    report.server = granted.server, report.scene = granted.scene, report.device = granted.device;
    report.width = granted.width, report.height = granted.height;
    crowd.leave();
    return run;
}

// True when every budget holds.
bool load(const Options& options) {
    Interrupt interrupt; // before any thread
    prepareFolder(options.out);
    Report report;
    report.machine = machine();
    Server server(options);
    try {
        std::cout << tableHead() << std::flush;
        for (const uint32_t viewers : options.viewers) {
            report.runs.push_back(measure(options, server, viewers, interrupt, report));
            const Run& run = report.runs.back();
            std::cout << tableLine(run) << std::flush;
            for (const Budget& budget : options.budgets)
                if (std::string line = broken(budget, run); !line.empty()) report.broken.push_back(std::move(line));
        }
    } catch (const std::exception& error) {
        if (!report.runs.empty()) write(report, options);               // what was measured is kept
        if (interrupt.asked()) throw std::runtime_error("interrupted"); // the server may have been, too
        const std::string end = server.ended();
        throw std::runtime_error(error.what() + (end.empty() ? "" : "; the server: " + end));
    }
    write(report, options);
    for (const std::string& line : report.broken) std::cerr << "brume-load: " << line << '\n';
    return report.broken.empty();
}

} // namespace

int main(int argc, char** argv) {
    int exit_code = 0;
    const auto options = parseOptions(argc, argv, exit_code);
    if (!options) return exit_code;
    try {
        return load(*options) ? 0 : 1;
    } catch (const std::exception& error) {
        std::cerr << "brume-load: " << error.what() << std::endl;
        return 1;
    }
}

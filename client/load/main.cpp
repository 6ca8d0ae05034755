// brume-load: many viewers of brume servers; measures what each gets and costs. ./dev load builds and runs it.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <iostream>

#include <fmt/format.h>

#include "client/load/crowd.h"
#include "client/load/report.h"
#include "client/load/server.h"
#include "client/load/servers_report.h"
#include "client/load/usage.h"
#include "common/cores.h"

namespace {

using namespace brume::load;
using brume::client::Interrupt;

std::string machine() {
    double average = NAN;
    getloadavg(&average, 1);
    return fmt::format("{} cores, load average {:.2f} before the first run", brume::usableCores(), average);
}

// One number of viewers, from hello to goodbye.
Run measure(const Options& options, const Servers& servers, uint32_t viewers, Interrupt& interrupt, Report& report) {
    Crowd crowd(options, servers.endpoints(), viewers, interrupt);
    const double warm_up_s = crowd.enter();
    const bool some_may_be_away = options.reconnect && servers.endpoints().size() > 1;
    std::vector<Series> before, after;
    crowd.during([&] { before = servers.counters(some_may_be_away); });
    const Usage began = usage();
    Run run = crowd.watch(options.seconds);
    const Usage ended = usage();
    crowd.during([&] { after = servers.counters(some_may_be_away); });
    before.resize(run.servers.size()), after.resize(run.servers.size()); // a goodbye may have named further servers
    for (size_t i = 0; i < after.size(); ++i) readCounters(run.servers[i], before[i], after[i], run.seconds);
    run.server = total(run.servers);
    run.warm_up_s = warm_up_s;
    run.own_cpu_s = ended.own_cpu_s - began.own_cpu_s;
    run.machine_busy_s = ended.busy_s - began.busy_s;
    const auto& granted = crowd.granted();
    report.server = granted.server, report.scene = granted.scene, report.device = granted.device;
    report.width = granted.width, report.height = granted.height;
    crowd.leave();
    return run;
}

// True when every budget holds and all servers agree.
bool load(const Options& options) {
    Interrupt interrupt; // before any thread
    prepareFolder(options.out);
    Report report;
    report.machine = machine();
    Servers servers(options);
    try {
        std::cout << tableHead() << std::flush;
        for (const uint32_t viewers : options.viewers) {
            report.runs.push_back(measure(options, servers, viewers, interrupt, report));
            const Run& run = report.runs.back();
            std::cout << tableLine(run) << std::flush;
            if (std::string line = differenceLine(run); !line.empty()) report.broken.push_back(std::move(line));
            for (const Budget& budget : options.budgets)
                if (std::string line = broken(budget, run); !line.empty()) report.broken.push_back(std::move(line));
        }
    } catch (const std::exception& error) {
        if (!report.runs.empty()) write(report, options);               // what was measured is kept
        if (interrupt.asked()) throw std::runtime_error("interrupted"); // the server may have been, too
        const std::string end = servers.ended();
        throw std::runtime_error(error.what() + (end.empty() ? "" : "; the server: " + end));
    }
    if (tellsServers(options)) std::cout << '\n' << serversText(report.runs) << std::flush;
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

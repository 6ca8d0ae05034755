// The servers under load: those that run already, or one that is started here and stopped at the end.
#pragma once

#include <memory>
#include <vector>

#include "client/load/options.h"
#include "client/load/run.h"
#include "client/load/scrape.h"
#include "common/process.h"

namespace brume::load {

class Servers {
public:
    // Starts a server if the options name none, and waits until it listens. Throws std::runtime_error, one line with
    // the server's last output, if it does not listen, or if nobody answers at one that the options name.
    explicit Servers(const Options& options);
    ~Servers(); // stops a server that was started here

    const std::vector<client::Endpoint>& endpoints() const { return endpoints_; }
    // The present values of each server's counters. Throws std::runtime_error, one line, if one does not answer.
    // `some_may_be_away`: true: the series of one that does not answer is empty.
    std::vector<Series> counters(bool some_may_be_away) const;
    // How a server that was started here ended, in one line; empty while it runs, or if it was not started here.
    std::string ended();

private:
    std::unique_ptr<Process> process_;
    std::vector<client::Endpoint> endpoints_;
};

// What a run cost a server, from its counters before and after the run. NaN: it does not tell that, or began anew.
ServerCost costBetween(const Series& before, const Series& after);
// The cost of several servers together: sums, and the largest of what is no sum.
ServerCost total(const std::vector<ServerRun>& servers);
// Reads from the counters of a run of so many seconds what `server` tells of itself.
void readCounters(ServerRun& server, const Series& before, const Series& after, double seconds);

} // namespace brume::load

// The server under load: one that runs already, or one that is started here and stopped at the end.
#pragma once

#include <memory>

#include "client/load/options.h"
#include "client/load/run.h"
#include "client/load/scrape.h"
#include "common/process.h"

namespace brume::load {

class Server {
public:
    // Starts a server if the options name none, and waits until it listens. Throws std::runtime_error, one line with
    // the server's last output, if it does not listen.
    explicit Server(const Options& options);
    ~Server(); // stops a server that was started here

    const client::Endpoint& endpoint() const { return endpoint_; }
    // The present values of its counters. Throws std::runtime_error, one line.
    Series counters() const;
    // How a server that was started here ended, in one line; empty while it runs, or if it was not started here.
    std::string ended();

private:
    std::unique_ptr<Process> process_;
    client::Endpoint endpoint_;
};

// What a run cost the server, from its counters before and after the run.
ServerCost costBetween(const Series& before, const Series& after);

} // namespace brume::load

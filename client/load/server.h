// The server under load: one that runs already, or one that is started for the occasion and stopped after it.
#pragma once

#include <memory>

#include "client/load/options.h"
#include "client/load/run.h"
#include "client/load/scrape.h"
#include "common/process.h"

namespace brume::load {

class Server {
public:
    // Starts the server when the options name none, and waits until it listens. Throws std::runtime_error, one line with the
    // server's own last words, when it does not.
    explicit Server(const Options& options);
    ~Server(); // stops it if it was started here

    const client::Endpoint& endpoint() const { return endpoint_; }
    // Its counters as they are. Throws std::runtime_error, one line.
    Series counters() const;
    // How the server that was started here ended, in one line; empty while it runs, or when it was not.
    std::string ended();

private:
    std::unique_ptr<Process> process_;
    client::Endpoint endpoint_;
};

// What a run cost the server, by its counters before and after.
ServerCost costBetween(const Series& before, const Series& after);

} // namespace brume::load

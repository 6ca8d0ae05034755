// The network side of the server: one port for the page, health, metrics, pictures and viewers.
#pragma once

#include <chrono>
#include <memory>

#include "server/net/metrics.h"
#include "server/net/options.h"
#include "server/viewer/audience.h"

namespace brume {

class NetServer {
public:
    // `audience` and `metrics` outlive the server.
    NetServer(net::NetOptions options, Audience& audience, Metrics& metrics);
    ~NetServer(); // stops at once

    // Listens and serves on threads of its own. Throws std::runtime_error, in one line that says what to do, when it cannot
    // listen.
    void start();
    // The port in use, after start().
    uint16_t port() const;
    // Accepts no more, tells every viewer goodbye, and waits for the connections to end; after `grace` they are cut. Once.
    void stop(std::chrono::milliseconds grace);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace brume

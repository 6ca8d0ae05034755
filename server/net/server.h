// The network side of the server: one port for the page, health, metrics, pictures and viewers.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "server/net/metrics.h"
#include "server/net/options.h"
#include "server/viewer/audience.h"

namespace brume {

class NetServer {
public:
    // `audience` and `metrics` outlive the server. Throws std::runtime_error, in one line, when the certificate is none.
    NetServer(net::NetOptions options, Audience& audience, Metrics& metrics);
    ~NetServer(); // stops at once

    // Listens and serves on threads of its own. Throws std::runtime_error, in one line that says what to do, when it cannot
    // listen.
    void start();
    // The port in use, after start().
    uint16_t port() const;
    // For the connections to come, while it serves: all but where it listens, its threads and the page's folder. A
    // certificate is read anew; when it is none, nothing changes and std::runtime_error is thrown. From the thread that called
    // start().
    void setOptions(net::NetOptions options);
    // /readyz fails from now on; all else goes on.
    void drain();
    // Accepts no more, tells every viewer goodbye and, unless it is empty, the URL `go_to`, and waits for the connections to end;
    // after `grace` they are cut. Once.
    void stop(std::chrono::milliseconds grace, std::string go_to = {});

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace brume

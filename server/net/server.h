// The network side of the server: one port for the page, health, metrics, pictures and viewers.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "server/metrics/metrics.h"
#include "server/net/options.h"
#include "server/viewer/audience.h"

namespace brume {

// Throws what NetServer would throw of a port that is taken, or of a certificate that cannot be used: soon, where much
// is to be done before that.
void checkNetwork(const net::NetOptions& options);

namespace net {
class Rooms;
}

class NetServer {
public:
    // `audience` and `metrics` outlive the server. Throws std::runtime_error, in one line, if the certificate cannot be
    // used.
    NetServer(net::NetOptions options, Audience& audience, Metrics& metrics);
    ~NetServer(); // stops at once

    // Listens and serves on threads of its own. Throws std::runtime_error, in one line that says what to do, if it
    // cannot.
    void start();
    // The port in use, after start().
    uint16_t port() const;
    // Sets the options of later connections, except where the server listens, its threads and the page's folder. Reads
    // the certificate anew; if that fails, nothing changes and std::runtime_error is thrown. From the thread that
    // called start().
    void setOptions(net::NetOptions options);
    // Sets of options that are kept: the newest, and those of open connections. For tests.
    uint32_t contexts() const;
    // The room at "/" is the audience's. Others may be added at any time.
    net::Rooms& rooms();
    // /readyz fails from now on; all else goes on.
    void drain();
    // `elsewhere` gives the URL of the other server with the most room, or nothing where there is none. Viewers for
    // whom this server has no place are told it, and so are those of a server that stops. Called seldom, from any
    // thread, under a lock: once another one is set, `elsewhere` is not called any more. At any time.
    void setElsewhere(std::function<std::string()> elsewhere);
    // Closes the ports, tells every viewer goodbye and where to go on, and waits for the connections to end; after
    // `grace` they are cut. Viewers go on to the URL `go_to` or, where that is empty, to setElsewhere()'s. A second
    // call does nothing.
    void stop(std::chrono::milliseconds grace, std::string go_to = {});

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace brume

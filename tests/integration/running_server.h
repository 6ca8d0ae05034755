// RunningServer: brume-server as a child process.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/native/endpoint.h"
#include "tests/integration/process.h"

namespace brume::test {

class RunningServer {
public:
    // Starts scene `cloud` on a free port, unless the arguments say otherwise, and waits until the server is ready.
    // Lack of time refuses nobody, unless they say otherwise.
    // Throws std::runtime_error with its output if it does not become ready.
    // `environment`: as of Process.
    explicit RunningServer(const std::vector<std::string>& arguments = {},
                           const std::vector<std::string>& environment = {});

    uint16_t port() const { return port_; }
    client::Endpoint endpoint() const { return {"127.0.0.1", port_, "/ws"}; }
    std::string url() const { return "ws://127.0.0.1:" + std::to_string(port_); }
    Process& process() { return *process_; }

private:
    std::unique_ptr<Process> process_;
    uint16_t port_ = 0;
};

// Starts the server with exactly these arguments and does not wait.
std::unique_ptr<Process> startServer(const std::vector<std::string>& arguments,
                                     const std::vector<std::string>& environment = {});

} // namespace brume::test

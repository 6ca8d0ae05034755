// NatsServer: Debian's nats-server with JetStream as a child process, on a free port of this machine.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/integration/process.h"

namespace brume::test {

class NatsServer {
public:
    // Starts it with a store of its own, which is deleted at the end, and waits until it takes connections. Throws
    // std::runtime_error with its output.
    explicit NatsServer(const std::vector<std::string>& arguments = {});
    ~NatsServer();

    std::string url() const { return "nats://127.0.0.1:" + std::to_string(port_); }
    uint16_t port() const { return port_; }
    const std::filesystem::path& store() const { return store_; }
    Process& process() { return *process_; }
    // Kills it at once, as a power loss of the program alone.
    void kill();
    // Starts it again on the same port and store.
    void start();

private:
    std::vector<std::string> arguments_;
    std::filesystem::path store_;
    std::unique_ptr<Process> process_;
    uint16_t port_ = 0;
};

} // namespace brume::test

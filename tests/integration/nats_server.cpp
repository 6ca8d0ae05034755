#include "tests/integration/nats_server.h"

#include <csignal>
#include <stdexcept>

#include <unistd.h>

namespace brume::test {
namespace {

std::filesystem::path newStore() {
    static int count = 0;
    return std::filesystem::temp_directory_path() /
           ("brume-nats-" + std::to_string(getpid()) + "-" + std::to_string(++count));
}

} // namespace

NatsServer::NatsServer(const std::vector<std::string>& arguments) : arguments_(arguments), store_(newStore()) {
    start();
}

NatsServer::~NatsServer() {
    process_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(store_, ignored);
}

void NatsServer::start() {
    std::vector<std::string> command{"/usr/sbin/nats-server", // Debian's
                                     "-a",
                                     "127.0.0.1",
                                     "-p",
                                     port_ ? std::to_string(port_) : "-1",
                                     "-T=false",
                                     "-l",
                                     "/dev/stdout"};
    if (arguments_.empty()) command.insert(command.end(), {"-js", "-sd", store_.string()});
    command.insert(command.end(), arguments_.begin(), arguments_.end());
    process_ = std::make_unique<Process>(command);
    const std::string prefix = "[" + std::to_string(process_->id()) + "] [INF] ";
    const auto port = process_->lineStarting(prefix + "Listening for client connections on 127.0.0.1:");
    if (!port || !process_->lineStarting(prefix + "Server is ready"))
        throw std::runtime_error("nats-server does not get ready: " + process_->out() + process_->err());
    port_ = static_cast<uint16_t>(std::stoi(*port));
}

void NatsServer::kill() {
    process_->signal(SIGKILL);
    process_->exitCode();
}

} // namespace brume::test

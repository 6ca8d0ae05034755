#include "tests/integration/running_server.h"

#include <algorithm>
#include <stdexcept>

namespace brume::test {

std::unique_ptr<Process> startServer(const std::vector<std::string>& arguments) {
    std::vector<std::string> command{BRUME_SERVER};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return std::make_unique<Process>(command);
}

RunningServer::RunningServer(const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"--port", "0"};
    if (std::find(arguments.begin(), arguments.end(), "--scene") == arguments.end()) all.insert(all.end(), {"--scene", "cloud"});
    all.insert(all.end(), arguments.begin(), arguments.end());
    process_ = startServer(all);
    const auto port = process_->lineStarting("listening on http://127.0.0.1:");
    if (!port) throw std::runtime_error("the server does not get ready: " + process_->out() + process_->err());
    port_ = static_cast<uint16_t>(std::stoi(*port));
}

} // namespace brume::test

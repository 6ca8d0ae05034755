#include "tests/integration/running_server.h"

#include <algorithm>
#include <stdexcept>

namespace brume::test {

std::unique_ptr<Process> startServer(const std::vector<std::string>& arguments,
                                     const std::vector<std::string>& environment) {
    std::vector<std::string> command{BRUME_SERVER};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return std::make_unique<Process>(command, environment);
}

RunningServer::RunningServer(const std::vector<std::string>& arguments, const std::vector<std::string>& environment) {
    std::vector<std::string> all = arguments;
    const auto given = [&](const char* name) { return std::find(all.begin(), all.end(), name) != all.end(); };
    if (!given("--port")) all.insert(all.end(), {"--port", "0"});
    if (!given("--scene")) all.insert(all.end(), {"--scene", "cloud"});
    if (!given("--ahead")) all.insert(all.end(), {"--ahead", "off"}); // what would be compiled is compiled by the tests
    if (!given("--most-frame-time")) all.insert(all.end(), {"--most-frame-time", "60000"}); // whatever runs beside
    process_ = startServer(all, environment);
    const auto port = process_->lineStarting("listening on http://127.0.0.1:");
    if (!port) throw std::runtime_error("the server does not get ready: " + process_->out() + process_->err());
    port_ = static_cast<uint16_t>(std::stoi(*port));
}

} // namespace brume::test

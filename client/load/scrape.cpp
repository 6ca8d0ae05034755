#include "client/load/scrape.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "client/native/http_get.h"

namespace brume::load {

constexpr uint64_t kMostBytes = 8 << 20;

Series parseSeries(std::string_view text) {
    Series all;
    while (!text.empty()) {
        const size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        // A label's text may have spaces: the name ends with its brace when it has one.
        const size_t brace = line.rfind('}'), space = line.find(' ', brace == line.npos ? 0 : brace);
        if (line.empty() || line[0] == '#' || space == line.npos) continue;
        const std::string number(line.substr(space + 1)); // a time may follow it
        char* parsed = nullptr;
        const double value = std::strtod(number.c_str(), &parsed);
        if (parsed != number.c_str()) all.emplace(line.substr(0, space), value);
    }
    return all;
}

Series scrape(const client::Endpoint& server, std::chrono::milliseconds timeout) try {
    return parseSeries(client::httpGet(server, "/metrics", timeout, kMostBytes));
} catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string("/metrics cannot be read: ") + error.what());
}

} // namespace brume::load

// Reads a server's /metrics.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <string_view>

#include "client/native/endpoint.h"

namespace brume::load {

// Values by the name of their time series as it stands in the text: brume_frames_total{fate="sent"}. The text is in
// Prometheus' exposition format, version 0.0.4; lines without a name and a number are left out.
using Series = std::map<std::string, double, std::less<>>;
Series parseSeries(std::string_view text);

// Asks the server. Throws std::runtime_error, one line, if no good answer comes in time.
Series scrape(const client::Endpoint& server, std::chrono::milliseconds timeout);

} // namespace brume::load

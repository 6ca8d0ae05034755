// What a server says of itself: its /metrics, read.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <string_view>

#include "client/native/endpoint.h"

namespace brume::load {

// Values by time series, written as in the text: brume_frames_total{fate="sent"}. Prometheus' exposition format, version 0.0.4:
// lines that are not a name and a number are passed over.
using Series = std::map<std::string, double, std::less<>>;
Series parseSeries(std::string_view text);

// Throws std::runtime_error, one line, when there is no such answer in time.
Series scrape(const client::Endpoint& server, std::chrono::milliseconds timeout);

} // namespace brume::load

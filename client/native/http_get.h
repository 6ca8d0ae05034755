// One GET of HTTP: what a server answers at once.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "client/native/endpoint.h"

namespace brume::client {

// The body of the answer, which has to come within `timeout` and be no longer than `most` bytes. The endpoint's own
// path is not used. Throws std::runtime_error, one line that says why there is no such answer.
std::string httpGet(const Endpoint& server, const std::string& path, std::chrono::milliseconds timeout, uint64_t most);

} // namespace brume::client

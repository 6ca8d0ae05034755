// A viewer's command as JSON and back, bit for bit.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "server/sim/command.h"

namespace brume {

// {"viewer":1,"seq":2,"impulse":{"origin":[0,0,26],...}}; settings are {"set":[["medium.falloff",2],...]}.
// Finite numbers only.
nlohmann::json toJson(const Command& command);
// Reads what toJson() writes, and {"set_medium":{"falloff":2}} of recordings of version 1. Throws
// nlohmann::json::exception or std::runtime_error for anything else.
Command commandOf(const nlohmann::json& json);

} // namespace brume

// A viewer's command as JSON and back, bit for bit.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "server/sim/command.h"

namespace brume {

// {"viewer":1,"seq":2,"impulse":{"origin":[0,0,26],...}}; fields that are not set are left out. Finite numbers only.
nlohmann::json toJson(const Command& command);
// Throws nlohmann::json::exception or std::runtime_error when it is not exactly what toJson() writes.
Command commandOf(const nlohmann::json& json);

} // namespace brume

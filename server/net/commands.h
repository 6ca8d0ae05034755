// From a viewer's input to a command for the simulation, every number checked.
#pragma once

#include <string>
#include <variant>

#include "protocol/message.h"
#include "server/sim/command.h"
#include "server/viewer/audience.h"

namespace brume::net {

// Why a message is not taken: sent to the viewer, in one line.
struct Refusal {
    wire::ErrorCode code;
    std::string text;
};

// The least role that may give a command: of settings, the highest that theirs take (common/settings.h).
wire::Role roleFor(const CommandBody& body);

// Precondition: `input` comes from wire::parse. Directions come back normalised; names are among `facts`. A viewer whose role is
// too low is told that before anything else.
std::variant<CommandBody, Refusal> readCommand(const wire::Input& input, const SceneFacts& facts, wire::Role role);

} // namespace brume::net

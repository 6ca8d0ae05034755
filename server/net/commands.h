// Which commands of a viewer this server takes.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "server/net/command_message.h"
#include "server/viewer/audience.h"

namespace brume::net {

// The least role that may give a command: of settings, the highest that theirs take (common/settings.h).
wire::Role roleFor(const CommandBody& body);

// The medium that is shown, for commands that name its particles.
struct ShownMedium {
    Layout layout = Layout::cube;
    uint32_t rows = 0; // medium.count
};

// Precondition: `input` comes from wire::parse. In the result names are among `facts`.
// A viewer whose role is too low is told that before anything else.
std::variant<CommandBody, Refusal> readCommand(const wire::Input& input, const ServerFacts& facts,
                                               const ShownMedium& medium, wire::Role role);

// True or false where a command to a replay pauses it or lets it go on; nothing for all other commands.
std::optional<bool> pauseOf(const CommandBody& body);

} // namespace brume::net

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
struct NamedParticles {
    Layout layout = Layout::cube;
    uint32_t rows = 0; // medium.count
};

// Precondition: `input` comes from wire::parse. In the result names are among `facts`.
// A viewer whose role is too low is told that before anything else.
std::variant<CommandBody, Refusal> readCommand(const wire::Input& input, const ServerFacts& facts,
                                               const NamedParticles& medium, wire::Role role);

// Gives a command to the scene, or to the replay: why it is not taken now, or nothing. `input_seq`: the number that its
// viewer gave it.
std::optional<Refusal> giveCommand(Audience& audience, uint32_t viewer, uint32_t input_seq, const CommandBody& body);

} // namespace brume::net

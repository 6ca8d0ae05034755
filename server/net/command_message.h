// A command as a message of brume.v1: viewers send it so, recordings and a cluster's log keep it so.
#pragma once

#include <optional>
#include <string>

#include "protocol/message.h"
#include "server/sim/command.h"

namespace brume::net {

// Why an input is refused, for the viewer: one line.
struct Refusal {
    wire::ErrorCode code;
    std::string text;
};

struct ReadCommand {
    CommandBody body; // what could be read of it
    std::optional<Refusal> refusal;
};
// What an input asks for, with the same bits. Its settings are live, and its numbers within their limits. It may have
// names that nothing has. Precondition: `input` comes from wire::parse.
ReadCommand readCommand(const wire::Input& input);

// The message of a command, in base64 (RFC 4648). It leaves out who asked.
std::string textOf(const Command& command);
// The same command, of viewer 0. Throws std::runtime_error, with a part of a line, for any other text.
Command commandOf(const std::string& text);

} // namespace brume::net

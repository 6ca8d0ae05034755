// LitReader: reads LitParticles of one connection. Everything that they say is checked.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "protocol/lit_particles.h"
#include "protocol/message.h"

namespace brume::client {

class LitReader {
public:
    // The rows of a message; null if it is none that a viewer can draw: why() says why, in one line. Valid until the
    // next call. `message`: verified by wire::parse(), `bytes`: what follows it.
    const lit::Rows* read(const wire::LitParticles& message, std::span<const uint8_t> bytes);
    const std::string& why() const { return why_; }

    // What is wrong with a message's own numbers; empty: nothing is.
    static std::string problemOf(const wire::LitParticles& message);

private:
    std::array<std::pair<uint32_t, lit::Rows>, lit::kLayers>
        held_; // the newest of each layer, with its number; 0: none
    std::string why_;
};

} // namespace brume::client

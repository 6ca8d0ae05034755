// What a command asks of the plan.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <variant>

#include "server/sim/command.h"

namespace brume {

// soon: with the next plan that there is time for. Values of the medium and of lights are in the next picture without a
// plan.
enum class Asks : uint8_t { nothing, soon, at_once };

// Particles that are pushed or set many times a second are looked at as those that move by themselves are.
inline Asks asksFor(const CommandBody& command) {
    if (std::holds_alternative<SetParticles>(command) || std::holds_alternative<Impulse>(command)) return Asks::nothing;
    if (std::holds_alternative<MoveVolume>(command)) return Asks::soon;
    const auto* set = std::get_if<Set>(&command);
    const bool renders = !set || std::ranges::any_of(set->changes, [](const Change& change) {
        const std::string_view path = change.setting->path;
        return path.starts_with("render.") && path != "render.exposure";
    });
    return renders ? Asks::at_once : Asks::soon;
}

} // namespace brume

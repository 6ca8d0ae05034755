#include "server/net/commands.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "server/net/access.h"

namespace brume::net {
namespace {

using Judgement = std::optional<Refusal>;

Judgement unknownName(const std::vector<Change>& changes, const ServerFacts& facts) {
    for (const Change& change : changes) {
        const auto* name = std::get_if<std::string>(&change.value);
        if (!name) continue;
        const std::vector<std::string> names = facts.choicesOf(*change.setting);
        if (std::find(names.begin(), names.end(), *name) == names.end())
            return Refusal{wire::ErrorCode::unknown_name,
                           fmt::format("no such {}; there is {}", change.setting->key(), fmt::join(names, ", "))};
    }
    return {};
}

// Why this server cannot take a command now.
struct Judge {
    const ServerFacts& facts;
    const NamedParticles& medium;

    Judgement operator()(const Set& c) const { return unknownName(c.changes, facts); }
    Judgement operator()(const Add& c) const { return unknownName(c.changes, facts); }
    Judgement operator()(const SetParticles& c) const {
        if (medium.layout != Layout::live)
            return Refusal{wire::ErrorCode::unexpected,
                           "this scene sets its own particles: SetParticles is for layout \"live\""};
        if (std::string problem = problemOf(c, medium.rows); !problem.empty())
            return Refusal{wire::ErrorCode::out_of_range, std::move(problem)};
        return {};
    }
    Judgement operator()(const Impulse&) const {
        if (medium.layout == Layout::volume)
            return Refusal{wire::ErrorCode::unexpected, "pushes move nothing here: the medium is a volume"};
        if (medium.layout != Layout::live && medium.layout != Layout::sequence) return {};
        return Refusal{wire::ErrorCode::unexpected, "pushes move nothing here: the particles come from elsewhere"};
    }
    template <class Other>
    Judgement operator()(const Other&) const {
        return {};
    }
};

// True: the command pauses. False: it lets go on. Nothing: it does neither.
std::optional<bool> pauseOf(const CommandBody& body) {
    const auto* set = std::get_if<Set>(&body);
    if (!set || set->changes.size() != 1 || set->changes[0].setting != liveSetting("simulation.paused")) return {};
    return std::get<bool>(set->changes[0].value);
}

} // namespace

wire::Role roleFor(const CommandBody& body) {
    const auto* set = std::get_if<Set>(&body);
    const bool costs_everyone = set && std::ranges::any_of(set->changes, [](const Change& one) {
                                    return one.setting->changed_by == ChangedBy::operators;
                                });
    const bool for_operators =
        costs_everyone || std::holds_alternative<Restart>(body) || std::holds_alternative<SetParticles>(body);
    if (for_operators) return wire::Role::operator_;
    return std::holds_alternative<Impulse>(body) ? wire::Role::pusher : wire::Role::controller;
}

std::variant<CommandBody, Refusal> readCommand(const wire::Input& input, const ServerFacts& facts,
                                               const NamedParticles& medium, wire::Role role) {
    ReadCommand read = readCommand(input);
    if (const wire::Role least = roleFor(read.body); !atLeast(role, least))
        return Refusal{wire::ErrorCode::forbidden, forbidden(role, least)};
    if (!read.refusal) read.refusal = std::visit(Judge{facts, medium}, read.body);
    if (read.refusal) return *std::move(read.refusal);
    if (auto* undo = std::get_if<Undo>(&read.body)) undo->operators = role >= wire::Role::operator_;
    return std::move(read.body);
}

std::optional<Refusal> giveCommand(Audience& audience, uint32_t viewer, uint32_t input_seq, const CommandBody& body) {
    if (ReplayControl* const replay = audience.replay()) {
        const std::optional<bool> paused = pauseOf(body);
        if (paused) replay->paused = *paused;
        if (paused) return {};
        return Refusal{wire::ErrorCode::unexpected, "this is a replay: pause it, resume it, or POST /seek?tick=N"};
    }
    CommandQueue& queue = audience.commands();
    if (queue.push({viewer, input_seq, body})) return {};
    return Refusal{wire::ErrorCode::busy, whyRefused(queue, body)};
}

} // namespace brume::net
